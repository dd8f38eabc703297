// SPDX-License-Identifier: MIT
#pragma once
// How far the torque of an effect is, along a motion, from all that other effects could make of it.

#include <string_view>
#include <vector>

#include "ripplenotch/model/model.hpp"

namespace ripplenotch {

/// What is to be told from something else.
struct AskedTerm {
    Term term;                          ///< with its values
    Model rest;                         ///< the model without it, every value stated
    std::vector<const Effect*> rivals;  ///< each may stand in its place
    double scale = 1.0;                 ///< of its torque: what cancels is no larger than what is there
    bool open = true;                   ///< whether the log left it open
    double needed = 0.0;                ///< gain
    double gain_before = 0.0;           ///< along the log
};

struct Separation {
    double squares = 0.0;    ///< of the torque that only the term brings, Nm^2
    std::string_view rival;  ///< that leaves the least of it; empty: none is asked about
};

/// Every column has an entry per sample of `motion`.
[[nodiscard]] Separation separation(const AskedTerm& asked, const Motion& motion);

/// The rival with the values with which it is nearest to the term along `motion`, beside the rest; false
/// where no place of it takes up anything.
[[nodiscard]] bool nearest_rival(const AskedTerm& asked, const Effect& rival, const Motion& motion,
                                 Term& found);

}  // namespace ripplenotch
