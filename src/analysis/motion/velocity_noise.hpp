// SPDX-License-Identifier: MIT
#pragma once
// Internal to the analysis room: how fast a sum of noisy velocities walks away from the angle.

#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {

/// Variance that the velocity's noise adds to its sum in each second, in deg^2/s: the noise of means over
/// 25 ms, which motion hardly bends, times their length. From third differences of neighbouring means (the
/// squares of 1, 3, 3, 1 are 20 together), by their median, so that a few jerks do not count; and what a
/// velocity in coarse steps is off by where it turns. 0 for a log of fewer than a hundred means.
[[nodiscard]] double velocity_noise(const TraceView& log);

}  // namespace ripplenotch
