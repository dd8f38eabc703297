// SPDX-License-Identifier: MIT
#pragma once
// The ripple at each order by speed and direction.

#include <span>
#include <vector>

#include "ripplenotch/analysis/ripple_estimate.hpp"
#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {

/// The ripple at one order, in one direction and one range of speed.
struct RippleAtSpeed {
    RippleEstimate ripple;     ///< its false alarm counts all orders, directions and ranges as tries
    int direction = 1;         ///< -1: backward
    double speed_deg_s = 0.0;  ///< |mean|
    /// |speed|; the same in both directions.
    double speed_from_deg_s = 0.0, speed_to_deg_s = 0.0;
};

/// The segments of estimate_ripple() by their mean speed and direction, at most six ranges of speed, each
/// with the estimate that estimate_ripple() makes of all: by order, then speed, then forward and backward.
[[nodiscard]] std::vector<RippleAtSpeed> amplitude_by_speed(std::span<const TraceView> logs, GearRatio ratio,
                                                            std::span<const Order> orders);

}  // namespace ripplenotch
