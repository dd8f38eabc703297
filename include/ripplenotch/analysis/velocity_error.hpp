// SPDX-License-Identifier: MIT
#pragma once
// Offset and noise of a logged velocity.

#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {

/// Offset of the logged velocity, with its standard error.
struct VelocityError {
    DegPerSec offset, offset_error;
};

/// Standard deviation of the velocity's noise, row by row, while the joint moves: what makes a supervisor
/// switch back and forth at the edge of a band. From third differences of rows 10 ms apart, of which motion
/// of some hertz adds little (the squares of 1, 3, 3, 1 are 20 together), by their median, so that jerks do
/// not count. Steps of an encoder count as noise. 0 for a log of fewer than a hundred such rows.
[[nodiscard]] DegPerSec velocity_noise(const TraceView& log);

}  // namespace ripplenotch
