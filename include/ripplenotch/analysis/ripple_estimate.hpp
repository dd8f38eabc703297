// SPDX-License-Identifier: MIT
#pragma once
// How large the ripple of a known gear is at each of its orders, how sure that is, and how small a ripple
// would have been seen: the one answer that every command gives of a log.

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {

/// Probability that noise alone makes any of the requested orders count as present.
inline constexpr double ripple_false_alarm = 0.01;
/// Motor orders within which lines are one line, under a Hann window of eight motor turns.
inline constexpr double ripple_resolution_orders = 1.5 / 8.0;

/// The ripple at one order.
struct RippleEstimate {
    double order = 0.0;              ///< cycles per motor turn
    double amplitude_nm = 0.0;       ///< zero to peak, rms over the segments, those with less noise counting
                                     ///< more; noise power subtracted
    double standard_error_nm = 0.0;  ///< from the noise near the order and the scatter over the segments
    /// Phase in cos(order * motor angle + phase); empty without an absolute angle, and where the segments do
    /// not agree on it.
    std::optional<double> phase_deg;
    double phase_standard_error_deg = 0.0;
    double detectable_nm = 0.0;  ///< a ripple of this amplitude would be present in 99 of 100 such logs
    double false_alarm = 1.0;    ///< probability that noise alone shows as much at any of the orders
    std::size_t segments = 0;
    double cycles = 0.0;                              ///< periods in all segments, which overlap by half
    double slowest_deg_s = 0.0, fastest_deg_s = 0.0;  ///< |speed| in the segments
    std::string insufficient;  ///< why the log does not show the order, one clause; empty: it was searched

    [[nodiscard]] bool searched() const { return insufficient.empty(); }
    [[nodiscard]] bool present() const { return searched() && false_alarm <= ripple_false_alarm; }
};

/// Least squares of complex amplitude in the measured angle. A segment is motion in one direction below the
/// speed at which the order reaches half the sample rate, cut into half-overlapping windows of at most eight
/// motor turns, or of as many as separate the orders (separating_window_turns). In each, all orders that it
/// holds four periods of and a trend are fitted at once, so that neighbours do not leak into each other,
/// under a Hann window in angle. The trend is a line and cosines in angle: 12 terms per output turn, but no
/// more than one for two periods of the lowest order, and never fewer than three. Of a log with more than
/// 300,000 rows in segments, which overlap, every second segment is left out, or of longer ones every fourth,
/// and so on. The noise is the median power of the residual 1.5 to 6.5 periods per window away from the
/// order, so that noise of any colour counts as it is; a ripple smaller than 1e-4 of the torque's range does
/// not count. One estimate per requested order. Throws UsageError for a ratio or an order that is not above
/// 0. Cost O(n (trend + 2 orders)^2).
[[nodiscard]] std::vector<RippleEstimate> estimate_ripple(std::span<const TraceView> logs, GearRatio ratio,
                                                          std::span<const Order> orders);

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

/// The ripple of a log, row by row.
struct RippleCourse {
    std::vector<double> nm;
    std::vector<bool> known;  ///< false in runs without a segment of estimate_ripple() for every order
};

/// The sum of the orders as estimate_ripple() fits them in its overlapping windows, each row by the weight
/// that it has there. Amplitude and phase between windows, and before the first and after the last, are those
/// of the nearest ones, interpolated: the ripple belongs to the motor's angle.
[[nodiscard]] RippleCourse ripple_course(const TraceView& log, GearRatio ratio,
                                         std::span<const Order> orders);

/// The ripple that is present, or its upper limit, order by order, with the speeds it was searched at.
[[nodiscard]] std::string ripple_text(std::span<const RippleEstimate> estimates);

}  // namespace ripplenotch
