// SPDX-License-Identifier: MIT
#pragma once
// Internal to the analysis module: an angle that a coarse encoder logs in steps.

#include <vector>

#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {

/// The angle between the steps of its encoder. Rounding to steps makes lines of its own: order o of amplitude
/// A is seen as well at k N + o and k N - o with A o / (k N), N steps per turn, folded at the sample rate.
struct SteppedAngle {
    std::vector<double> turns;
    double step_turns = 0.0;  ///< 0: the steps are too fine to matter, and `turns` is the angle as logged
};

/// Quadratics over half-overlapping windows, each as long as what it leaves of the logged angle is no more
/// than rounding leaves; the logged angle where none is. O(n log n).
[[nodiscard]] SteppedAngle between_steps(const TraceView& log, std::vector<double> logged_turns);

}  // namespace ripplenotch
