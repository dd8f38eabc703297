// SPDX-License-Identifier: MIT
#pragma once
// The ripple at each order by speed and direction, and whether it changes with them.

#include <optional>
#include <span>
#include <string>
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

/// Whether the amplitude at one order changes with speed or direction.
struct AmplitudeChange {
    double order = 0.0;
    /// Probability that a constant amplitude differs as much; empty with one speed, or one direction, alone.
    std::optional<double> speed_chance, direction_chance;
    std::string
        sentence;  ///< "order 2 grows with speed: 0.21 Nm at 20 deg/s to 0.38 Nm at 100 deg/s (p = ...)"
};

/// Largest probability with which a change is reported.
inline constexpr double change_false_alarm = 0.01;

struct AmplitudeBySpeed {
    std::vector<RippleAtSpeed> ripple;     ///< by order, then speed, then forward and backward
    std::vector<AmplitudeChange> changes;  ///< one per order that the log has
};

/// The segments of estimate_ripple() by their mean speed and direction, at most six ranges of speed, each
/// with the estimate that estimate_ripple() makes of all. A change is tested with the standard errors of
/// the amplitudes: with speed by a weighted trend over both directions and by Welch's analysis of
/// variance of each direction (1951), with direction by the weighted mean difference at the same speeds.
[[nodiscard]] AmplitudeBySpeed amplitude_by_speed(std::span<const TraceView> logs, GearRatio ratio,
                                                  std::span<const Order> orders);

}  // namespace ripplenotch
