// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "analysis/lines/conclude.hpp"
#include "analysis/lines/disagreement.hpp"
#include "analysis/lines/reported_line.hpp"
#include "analysis/lines/tones_and_hums.hpp"
#include "ripplenotch/analysis/gear_ratio.hpp"
#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/analysis/motion_lines.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

/// What a joint carries repeats once a turn, with and without a gear: such a line says nothing of the ratio.
bool is_once_a_turn(const OrderLine& line) {
    constexpr double tolerance = 0.02;  // by hand: of the joint's turn, beside the line's own error
    return std::abs(line.order_output - 1.0) < std::max(tolerance, 3.0 * line.error);
}

/// Fits the ratio to what may be orders and writes each line's order per motor turn.
void add_ratio(std::vector<Reported>& reported, const RatioQuestion& question, Identification& result) {
    std::vector<OrderLine> orders;
    std::vector<std::size_t> owner;
    for (std::size_t i = 0; i < reported.size(); ++i) {
        if (!reported[i].order || is_once_a_turn(*reported[i].order)) continue;
        orders.push_back(*reported[i].order);
        owner.push_back(i);
    }
    GearRatioResult ratio = fit_gear_ratio(orders, question);
    result.gear_ratio = std::move(ratio.fit);
    for (std::string& note : ratio.notes) result.notes.push_back(std::move(note));
    for (std::size_t i = 0; i < owner.size(); ++i) {
        if (const auto n = ratio.order_of_line[i]) reported[owner[i]].line.order = *n;
    }
}

/// Mean over the logs, weighed by their durations. Throws DataError for a log with too few samples.
Hertz mean_sample_rate(std::span<const TraceView> logs) {
    double seconds = 0.0, samples = 0.0;
    for (const TraceView& log : logs) {
        if (log.size() < fewest_identify_samples) {
            raise<DataError>("a log has {} samples, at least {} are needed to look for lines", log.size(),
                             fewest_identify_samples);
        }
        seconds += static_cast<double>(log.size()) / log.sample_rate.value();
        samples += static_cast<double>(log.size());
    }
    return Hertz(seconds > 0.0 ? samples / seconds : 0.0);
}

/// What the logs say together, without asking whether each says so.
Identification identify_together(std::span<const TraceView> logs, const IdentifyOptions& options) {
    Identification result;
    result.sample_rate = mean_sample_rate(logs);
    MotionLinesOptions search;
    search.false_alarm = options.false_alarm;
    const MotionLines motion = find_motion_lines(logs, search);
    std::vector<Reported> reported;
    for (std::size_t i = 0; i < motion.lines.size(); ++i)
        reported.push_back(from_motion(motion, i, result.sample_rate.value()));
    result.velocity_error = motion.velocity_error;
    if (motion.sweeps > 0) result.evidence = "order spectrum";
    add_ratio(reported, {options.hint, options.hinted_orders}, result);
    result.families = families_among(reported);
    name_mains(reported);
    for (Reported& r : reported) {
        result.lines.push_back(std::move(r.line));
    }
    std::stable_sort(result.lines.begin(), result.lines.end(),
                     [](const Line& a, const Line& b) { return a.amplitude_nm > b.amplitude_nm; });
    result.hums = hums_beside(motion, result.lines);
    conclude(motion, options, result);
    return result;
}

}  // namespace

Identification identify(std::span<const TraceView> logs, const IdentifyOptions& options) {
    Identification together = identify_together(logs, options);
    const bool ripple = std::any_of(together.lines.begin(), together.lines.end(), [](const Line& line) {
        return line.kind != LineKind::tone && line.order_output;
    });
    if (ripple && logs.size() > 1) {
        std::vector<Identification> each;
        for (const TraceView& log : logs) each.push_back(identify_together({&log, 1}, options));
        together.disagreements = disagreements(together, each, logs);
        settle(together);
    }
    for (const Doubt& doubt : options.doubts) cast_doubt(together, doubt);
    return together;
}

}  // namespace ripplenotch
