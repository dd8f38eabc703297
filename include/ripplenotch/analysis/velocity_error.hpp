// SPDX-License-Identifier: MIT
#pragma once
// Gain error and delay of a logged velocity.

#include "ripplenotch/core/quantity.hpp"

namespace ripplenotch {

/// Gain error and delay of the logged velocity (the lag of a filter counts as delay), with standard errors.
/// Steady speeds determine the offset alone.
struct VelocityError {
    DegPerSec offset, offset_error;
    Seconds delay, delay_error;
    bool delay_told = true;
};

}  // namespace ripplenotch
