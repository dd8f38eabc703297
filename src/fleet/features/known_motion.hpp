// SPDX-License-Identifier: MIT
#pragma once
// Internal: in which rows of a log the joint's motion is known. Where the speed jumps, nobody knows the
// acceleration, and what is smoothed over the jump is no speed that the joint had.

#include <vector>

#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/model/effect.hpp"

namespace ripplenotch {

/// A 1 for each row within whose smoothing window the logged speed is that of `motion`, to 8 deviations of
/// its noise or a fiftieth of the usual speed; else 0. `motion` is motion_along(log).
[[nodiscard]] std::vector<unsigned char> rows_of_known_motion(const TraceView& log, const Motion& motion);

/// What the acceleration in the rows of known motion lets be told.
struct Accelerations {
    bool known = false;  ///< beside direction and speed, and beyond noise, which makes an inertia too small
    bool like_friction = false;  ///< known only along with direction and speed: inertia and friction alike
};
[[nodiscard]] Accelerations accelerations_of(const TraceView& log, const Motion& motion,
                                             const std::vector<unsigned char>& rows);

}  // namespace ripplenotch
