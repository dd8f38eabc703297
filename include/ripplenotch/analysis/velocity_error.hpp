// SPDX-License-Identifier: MIT
#pragma once
// Gain error, delay and noise of a logged velocity.

#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {

/// Gain error and delay of the logged velocity (the lag of a filter counts as delay), with standard errors.
/// Steady speeds determine the offset alone.
struct VelocityError {
    DegPerSec offset, offset_error;
    Seconds delay, delay_error;
    bool delay_told = true;
};

/// Standard deviation of the velocity's noise, row by row, while the joint moves: what makes a supervisor
/// switch back and forth at the edge of a band. From third differences of rows 10 ms apart, of which motion
/// of some hertz adds little (the squares of 1, 3, 3, 1 are 20 together), by their median, so that jerks do
/// not count. Steps of an encoder count as noise. 0 for a log of fewer than a hundred such rows.
[[nodiscard]] DegPerSec velocity_noise(const TraceView& log);

}  // namespace ripplenotch
