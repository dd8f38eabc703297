// SPDX-License-Identifier: MIT
#pragma once
// Whether a fitted shape is the effect's own.

#include <string_view>

#include "diagnose/search/model_bench.hpp"

namespace ripplenotch {

/// How a shape is bent.
struct Bend {
    std::string_view parameter;  ///< empty: it is not
    std::string_view rule;       ///< that says so
    double number = 0.0;         ///< what it was asked about
};

/// The first parameter of a term that is bent as far as its bounds allow, or so far that the torque is as
/// good as at a bound. Such an effect has lost what tells it from others: Stribeck friction of a Stribeck
/// speed far above all speeds is Coulomb friction. A bound at which the effect is what it is at its neutral
/// value, and one that the log hardly tells from a value within, bend nothing.
[[nodiscard]] Bend bend_of(const ModelBench& bench, const Candidate& model, std::size_t term);

}  // namespace ripplenotch
