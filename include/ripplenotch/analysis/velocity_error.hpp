// SPDX-License-Identifier: MIT
#pragma once
// What a logged velocity is off by.

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
