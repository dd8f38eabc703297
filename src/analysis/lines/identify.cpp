// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "analysis/lines/conclude.hpp"
#include "analysis/lines/disagreement.hpp"
#include "analysis/lines/hums.hpp"
#include "analysis/lines/reported_line.hpp"
#include "analysis/steady/tone_family.hpp"
#include "ripplenotch/analysis/gear_ratio.hpp"
#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/analysis/motion_lines.hpp"
#include "ripplenotch/analysis/steady_lines.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

/// Relative error of all orders alike, where a velocity's offset is only known within its own.
double shared_order_error(const Looked& looked, const Identification& result) {
    const bool steady = looked.steady && result.evidence == LineEvidence::stretches;
    return steady && looked.steady->offset ? looked.steady->offset->order_share_error : 0.0;
}

/// Fits the ratio to what may be orders and writes each line's order per motor turn.
void add_ratio(std::vector<Reported>& reported, const RatioQuestion& question, Identification& result) {
    std::vector<OrderLine> orders;
    std::vector<std::size_t> owner;
    for (std::size_t i = 0; i < reported.size(); ++i) {
        if (!reported[i].order) continue;
        orders.push_back(*reported[i].order);
        if (!reported[i].line.order_output_seen) orders.back().could_be = reported[i].line.could_be;
        owner.push_back(i);
    }
    GearRatioResult ratio = fit_gear_ratio(orders, question);
    result.gear_ratio = std::move(ratio.fit);
    for (std::string& note : ratio.notes) result.notes.push_back(std::move(note));
    for (std::size_t i = 0; i < owner.size(); ++i) {
        if (const auto n = ratio.order_of_line[i]) reported[owner[i]].line.order = *n;
    }
}

SteadyRule rule_of(const IdentifyOptions& options) {
    SteadyRule rule;
    rule.band_percent = options.steady_band_percent;
    rule.band_deg_s = options.steady_band_deg_s;
    rule.at_least = options.steady_for;
    return rule;
}

bool has_order(const std::vector<Reported>& reported) {
    return std::any_of(reported.begin(), reported.end(), [](const Reported& r) {
        return r.line.kind == LineKind::order || r.line.kind == LineKind::alias;
    });
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

MotionLines motion_lines_of(std::span<const TraceView> logs, const IdentifyOptions& options,
                            double false_alarm, bool nothing_steady_moves, std::vector<double> known_hz) {
    MotionLinesOptions motion;
    motion.false_alarm = false_alarm;
    motion.known_hz = std::move(known_hz);
    MotionLines found = find_motion_lines(logs, motion);
    if (found.sweeps > 0 || !nothing_steady_moves) return found;
    motion = short_log_options();
    motion.false_alarm = options.false_alarm;  // nothing else has been asked yet
    return find_motion_lines(logs, motion);
}

/// Where the motion cannot tell either, the stretches' own figures are the sharper ones.
bool motion_tells_more(const MotionLines& motion, const std::vector<Reported>& reported) {
    const bool motion_tells =
        std::any_of(motion.lines.begin(), motion.lines.end(),
                    [](const MotionLine& line) { return line.kind == LineKind::order; });
    const bool any_unknown = std::any_of(reported.begin(), reported.end(),
                                         [](const Reported& r) { return r.line.kind == LineKind::unknown; });
    return motion.sweeps > 0 && (motion_tells || !any_unknown);
}

/// Tones of the steady stretches stay; what was unknown there is what the motion now explains.
void add_motion_lines(const MotionLines& motion, const IdentifyOptions& options, Hertz sample_rate,
                      std::vector<Reported>& reported) {
    std::erase_if(reported, [](const Reported& r) { return r.line.kind != LineKind::tone; });
    for (std::size_t i = 0; i < motion.lines.size(); ++i) {
        const MotionLine& line = motion.lines[i];
        const bool known = line.kind == LineKind::tone &&
                           std::any_of(reported.begin(), reported.end(), [&](const Reported& r) {
                               return std::abs(*r.line.hz - line.hz) < 4.0 * line.hz_stderr + 0.5;
                           });
        if (!known) reported.push_back(from_motion(motion, i, options, sample_rate.value()));
    }
}

std::vector<ToneFamily> families_among(const std::vector<Reported>& reported) {
    std::vector<Tone> tones;
    for (const Reported& one : reported) {
        if (one.line.kind == LineKind::tone && one.line.hz) tones.push_back({*one.line.hz, one.hz_error});
    }
    const auto family = family_of(tones);
    return family ? std::vector{*family} : std::vector<ToneFamily>{};
}

/// What the logs say together, without asking whether each says so.
Identification identify_together(std::span<const TraceView> logs, const IdentifyOptions& options) {
    Identification result;
    Looked looked;
    result.sample_rate = mean_sample_rate(logs);
    std::vector<Reported> reported;
    using Way = IdentifyOptions::Way;
    // Automatic asks twice, so each way has half of the false alarms allowed.
    const double false_alarm =
        options.way == Way::automatic ? 0.5 * options.false_alarm : options.false_alarm;
    if (options.way != Way::order) {
        looked.steady = find_steady_lines(logs, rule_of(options), false_alarm);
        for (const SteadyLine& line : looked.steady->lines)
            reported.push_back(from_steady(logs, *looked.steady, line, options));
        result.evidence = LineEvidence::stretches;
        if (const auto& told = looked.steady->offset)
            result.velocity_error = VelocityError{told->offset, told->offset_error, {}, {}, false};
    }
    if (options.way != Way::steady && !has_order(reported)) {
        const bool nothing_steady_moves = !looked.steady || looked.steady->moving == 0;
        std::vector<double> tones;
        for (const Reported& one : reported) {
            if (one.line.kind == LineKind::tone) tones.push_back(*one.line.hz);
        }
        looked.motion = motion_lines_of(logs, options, false_alarm, nothing_steady_moves, std::move(tones));
        if (motion_tells_more(*looked.motion, reported)) {
            add_motion_lines(*looked.motion, options, result.sample_rate, reported);
            result.velocity_error = looked.motion->velocity_error;
            result.evidence = nothing_steady_moves ? LineEvidence::sweeps : LineEvidence::both;
        }
    }
    looked.without_position =
        std::any_of(logs.begin(), logs.end(), [](const TraceView& log) { return !log.has_position(); });
    add_ratio(reported,
              {options.hint, options.hinted_orders, looked.without_position,
               shared_order_error(looked, result), options.unit_stated},
              result);
    result.families = families_among(reported);
    name_mains(reported);
    for (Reported& r : reported) {
        result.lines.push_back(std::move(r.line));
    }
    std::stable_sort(result.lines.begin(), result.lines.end(),
                     [](const Line& a, const Line& b) { return a.amplitude_nm > b.amplitude_nm; });
    result.hums = hums_beside(looked, result.lines);
    conclude(looked, options, result);
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
