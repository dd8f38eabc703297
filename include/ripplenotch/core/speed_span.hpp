// SPDX-License-Identifier: MIT
#pragma once
#include "ripplenotch/core/units.hpp"

namespace ripplenotch {

/// Joint speeds from the slowest to the fastest.
struct SpeedSpan {
    DegPerSec from, to;
};

}  // namespace ripplenotch
