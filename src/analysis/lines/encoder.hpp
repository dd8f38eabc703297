// SPDX-License-Identifier: MIT
#pragma once
// Internal to the analysis module: an angle that a coarse encoder logs in steps, and the lines of the torque
// that the steps make.

#include <cstddef>
#include <span>
#include <vector>

#include "ripplenotch/analysis/line_search.hpp"
#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {

/// Takes lines off the list that the steps foretell: a drive that controls a rounded position puts its
/// rounding into the torque, at multiples of the steps per turn, folded at the sample rate. Each line is
/// asked whether the rounding of the smooth angle shows it too, in the sweeps that hold most of it. Returns
/// how many were taken off.
std::size_t take_off_encoder_lines(std::span<const TraceView> logs, const SweepRule& rule,
                                   std::vector<MotionLine>& lines);

/// The angle of a position between the steps of its encoder, as it was logged where these are too fine to
/// matter. Rounding to steps makes lines of its own: order o of amplitude A is seen as well at k N + o and
/// k N - o with A o / (k N), N steps per turn, folded at the sample rate. Quadratics over half-overlapping
/// windows, each as long as what it leaves of the logged angle is no more than rounding leaves; the logged
/// angle where none is. O(n log n).
[[nodiscard]] OutputAngle between_steps(const TraceView& log, std::vector<double> logged_turns);

}  // namespace ripplenotch
