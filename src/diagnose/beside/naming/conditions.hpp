// SPDX-License-Identifier: MIT
#pragma once
// What a name must be to be believed beside a leftover.

#include <optional>
#include <string>
#include <vector>

#include "diagnose/beside/naming/naming.hpp"
#include "diagnose/beside/naming/rivals.hpp"
#include "diagnose/beside/weighing/sameness.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {

/// One name under the conditions. Sizes and gains are of the whitened log.
struct BesideFinding {
    Shape shape;
    FindingStatus status = FindingStatus::confirmed;
    std::string reason;       ///< of another status
    bool is_driving = false;  ///< a friction that is withdrawn for a size below 0
    std::vector<Decision> decisions;
    OutsideGain gain;  ///< beside the other names
    double price = 0.0;
    Sameness same;
    double size_nm = 0.0;  ///< rms of its torque about its mean
    std::optional<Shape> rival;
    double rival_margin = 0.0, rival_t = 0.0;
};

/// A friction of a size below 0, and what it gained.
struct TooMuch {
    Shape shape;
    double gain = 0.0;
};

/// What a name is held against.
struct Judgement {
    std::size_t effects = 1;  ///< in the catalogue, for the price
    /// Whether a size that differs with the speed speaks against a name. It does where the leftover may be
    /// what an effect of the catalogue leaves that was not tried; beside a given term the leftover is
    /// another's.
    bool even_by_speed = false;
    LongerLook* longer = nullptr;  ///< where ties are looked at again; without one they stay
    bool simulated = false;        ///< a simulation is given, which may have too much of a friction
    /// Frictions of a size below 0 that were withdrawn beside one. A name has to stand beside each.
    std::vector<TooMuch> too_much = {};
};

[[nodiscard]] std::vector<BesideFinding> judged_beside(Sums& sums, const Named& now, const Judgement& by);

/// Names and their findings, in the same order; what was withdrawn comes after them.
struct NamedBeside {
    Named now;
    std::vector<BesideFinding> findings;
};
/// Searches, judges, and withdraws the weakest that is tentative, until none is.
[[nodiscard]] NamedBeside named_beside(Sums& sums, Judgement by);

}  // namespace ripplenotch
