// SPDX-License-Identifier: MIT
#pragma once
// Lines of a log in any motion: what repeats with the output angle (orders), what repeats with time (tones),
// and what this motion cannot distinguish.

#include <optional>
#include <vector>

#include "ripplenotch/analysis/identification.hpp"

namespace ripplenotch {

struct MotionLine {
    LineKind kind = LineKind::unknown;  ///< order, tone, or unknown: angle and time explain it alike
    double order_output = 0.0, order_stderr = 0.0;  ///< for kinds order and unknown
    double hz = 0.0, hz_stderr = 0.0;               ///< for kind tone
    double amplitude_nm = 0.0;                      ///< zero to peak, rms over sweeps, noise subtracted
    double floor_nm = 0.0;                          ///< amplitude of noise alone, rms over sweeps
    double snr = 0.0;                               ///< amplitude_nm / floor_nm
    double false_alarm = 1.0;                       ///< chance that noise alone gives as much anywhere
    /// Phase in cos(order * output angle + phase), when the sweeps agree on it.
    std::optional<double> phase_deg;
    std::vector<AmplitudeAtSpeed> by_speed;  ///< per sweep
};

struct MotionLinesOptions {
    SweepRule sweeps{.shortest_turns = 0.03, .fewest_samples = 40, .slowest_share = 0.05};
    double false_alarm = 0.01;   ///< chance that noise gives any line at all, orders and tones together
    double least_share = 1e-4;   ///< share of the torque's range: smaller lines are not reported
    double lowest_order = 12.0;  ///< lower ones are those of load and motion, where the travel is short
    /// Order 16 of a ratio of 160.
    double highest_order = 2560.0;
    double highest_folded_order = 2560.0;  ///< of those above half the sample rate
    double lowest_hz = 1.0;
    std::size_t most_lines = 24;  ///< chosen, not derived: each costs a further pass over all sweeps
};

struct MotionLines {
    std::vector<MotionLine> lines;      ///< in the order found: clearest first
    std::size_t sweeps = 0, rests = 0;  ///< pieces of motion and of standstill that were used
    std::size_t sweeps_left_out = 0;
    double turns = 0.0;  ///< output turns that the sweeps cover
    double resolution_orders = 0.0;
    double lowest_order = 0.0, highest_order = 0.0;   ///< between which lines of an order were looked for
    std::optional<SearchedOrders> searched;           ///< empty where no sweep allows a search
    double slowest_deg_s = 0.0, fastest_deg_s = 0.0;  ///< mean |speed| of the sweeps
    bool absolute_angle = false;
    /// The velocity error of logs without position, if their lines determine it; their angle and lines are
    /// corrected for it.
    std::optional<VelocityError> velocity_error;
    /// Relative error that all orders have in common, because the angle is a sum of velocities.
    double order_share_error = 0.0;
};

/// Takes the clearest line of both axes, as the order or the tone that explains more, subtracts it sweep by
/// sweep, and searches again, until noise could account for what is left. Where the angle is a sum of
/// velocities, the orders found determine the offset of the velocity; the search is repeated with it
/// corrected.
[[nodiscard]] MotionLines find_motion_lines(std::span<const TraceView> logs,
                                            const MotionLinesOptions& options);

}  // namespace ripplenotch
