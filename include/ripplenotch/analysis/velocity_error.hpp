// SPDX-License-Identifier: MIT
#pragma once
// What a logged velocity is off by.

#include "ripplenotch/core/quantity.hpp"

namespace ripplenotch {

/// The logged velocity is so much too high, and so late (a filter's lag is a delay, too). With standard
/// errors. Steady speeds show the offset alone.
struct VelocityError {
    DegPerSec offset, offset_error;
    Seconds delay, delay_error;
    bool delay_told = true;
};

}  // namespace ripplenotch
