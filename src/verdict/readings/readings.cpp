// SPDX-License-Identifier: MIT
#include "ripplenotch/verdict/readings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/analysis/ripple_estimate.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/log/log.hpp"
#include "ripplenotch/verdict/other_motors.hpp"

namespace ripplenotch {

namespace {

// What a log itself says against believing what identify finds in it.

// Position over velocity and time is known within 5 % where it is stated at all. A scale that is off by less
// moves a gear ratio by as little; the fit of the ratio speaks of it.
constexpr double agreement = 0.05;
constexpr double widest_clock = 5.0;  // no clock is off by more; a unit or a side is

// One entry a reason, each with what settles it, with the log read in this way. Empty for a log that does
// not contradict itself.
std::vector<Doubt> log_doubts(const Log& log, const OtherReading& reading) {
    const auto& factor = log.recording.angle.factor;
    if (!factor) return {};
    // A turned sign leaves every order where it is.
    const double size =
        std::abs(*factor) * reading.position_factor / (reading.velocity_factor * reading.time_factor);
    if (std::abs(size - 1.0) <= agreement) return {};
    const bool clock = size < widest_clock && size > 1.0 / widest_clock;
    return {{DoubtReason::clock,
             fmt::format(
                 "in {} the position changes {:.4g} times as much as velocity and time imply, so {}",
                 log.layout.source, size,
                 clock ? fmt::format("the clock or a unit is wrong: --sample-rate {:.4g}Hz would correct the "
                                     "clock, --unit the velocity or the position",
                                     log.recording.clock.nominal_rate.value() / reading.time_factor / size)
                       : "a unit is wrong, or one of the two is the motor's: --unit would correct it")}};
}

/// The ratio that motion of the motor's shaft is divided by where the real one is unknown, so that its
/// lines stand where those of a joint would.
constexpr double stand_in_ratio = 100.0;

constexpr double same_ratio = 0.02;  // by hand
constexpr double least_ratio = 3.0;  // less is no gear: what was logged turns with the motor

bool in_motor_units(std::span<const Log> logs) {
    return std::any_of(logs.begin(), logs.end(), [](const Log& log) { return log.layout.motor_units; });
}

std::vector<OtherReading> readings_of(std::span<const Log> logs, std::vector<Assumption> Layout::*list) {
    std::vector<OtherReading> found;
    for (const Log& log : logs) {
        for (const Assumption& assumption : log.layout.*list) {
            for (const OtherReading& other : assumption.others) {
                const auto same = [&](const OtherReading& known) { return known.words == other.words; };
                if (std::none_of(found.begin(), found.end(), same)) found.push_back(other);
            }
        }
    }
    return found;
}

// Lines at orders of a joint behind a gear of this ratio are lines at orders of the motor, and the speeds are
// those of the log again.
Identification of_the_motor(Identification found, double ratio) {
    std::string lines;
    for (Line& line : found.lines) {
        line.speed_from_deg_s *= ratio;
        line.speed_to_deg_s *= ratio;
        for (AmplitudeAtSpeed& at : line.by_speed) at.speed_deg_s *= ratio;
        if (!line.order_output) continue;
        line.order = *line.order_output / ratio;
        line.order_output.reset();
        line.order_output_stderr.reset();
        if (line.kind == LineKind::order)
            lines += fmt::format("{}{:.4g} ({:.2g} Nm)", lines.empty() ? "" : ", ", *line.order,
                                 line.amplitude_nm);
    }
    found.grounds.slowest_deg_s *= ratio;
    found.grounds.fastest_deg_s *= ratio;
    found.grounds.sweep_turns *= ratio;
    found.gear_ratio = {};
    found.conclusive = false;
    found.verdict = lines.empty() ? "Cannot tell: the motion is measured before the gear and its ratio is "
                                    "not known; --gear-ratio settles it."
                                  : fmt::format(
                                        "Cannot tell the gear ratio: the motion is measured before the gear. "
                                        "Ripple at {} cycles per turn of the motor. --gear-ratio settles it.",
                                        lines);
    return found;
}

/// Logs as they would be under a reading; those that it leaves as they are have no copy.
struct LogsRead {
    std::vector<Trace> traces;
    std::vector<TraceView> views;

    explicit LogsRead(std::span<const Log> logs, const OtherReading& reading = {}) {
        const bool as_taken =
            reading.time_factor == 1.0 && reading.velocity_factor == 1.0 && reading.position_factor == 1.0;
        traces.reserve(logs.size());
        for (const Log& log : logs)
            views.push_back(as_taken ? log.trace.view()
                                     : traces.emplace_back(read_otherwise(log.trace, reading)).view());
    }
};

/// What is before a gear of unknown ratio, as if it were behind the one that stands for it.
OtherReading behind_stand_in(OtherReading reading) {
    reading.velocity_factor /= stand_in_ratio;
    reading.position_factor /= stand_in_ratio;
    return reading;
}

Identification identified(std::span<const Log> logs, const IdentifyOptions& options,
                          const OtherReading& reading) {
    const bool motor = in_motor_units(logs) != reading.changes_side;
    const OtherReading read = motor ? behind_stand_in(reading) : reading;
    const LogsRead under(logs, read);
    IdentifyOptions doubting = options;
    if (motor) doubting.highest_order *= stand_in_ratio;  // to half the sample rate, per turn of the motor
    for (const Log& log : logs) {
        for (Doubt& doubt : log_doubts(log, read)) doubting.doubts.push_back(std::move(doubt));
    }
    Identification found = identify(under.views, doubting);
    return motor ? of_the_motor(std::move(found), stand_in_ratio) : found;
}

// The order of the strongest line that may turn with the joint, 0 where there is none; empty where it is
// stated per turn of the motor, by no known ratio.
std::optional<double> stated_order(const Identification& found) {
    for (const Line& line : found.lines) {
        if (line.kind == LineKind::tone) continue;
        if (line.order_output || line.order) return line.order_output;
    }
    return 0.0;
}

bool agree(const Identification& a, const Identification& b) {
    if (a.shows_no_line() && b.shows_no_line()) return true;
    if (a.conclusive != b.conclusive || a.gear_ratio.value.has_value() != b.gear_ratio.value.has_value())
        return false;
    if (a.gear_ratio.value) return std::abs(*a.gear_ratio.value / *b.gear_ratio.value - 1.0) < same_ratio;
    const auto first = stated_order(a), second = stated_order(b);
    return first && second && std::abs(*first - *second) <= same_ratio * *first;
}

Identification cannot_tell(Identification found, const std::string& assumed,
                           const std::vector<std::pair<OtherReading, Identification>>& others,
                           const std::string& options) {
    found.notes.push_back(fmt::format("{}: {}", assumed, found.verdict));
    for (const auto& [reading, other] : others)
        found.notes.push_back(fmt::format("if {} ({}): {}", reading.words, reading.option, other.verdict));
    found.verdict = fmt::format(
        "Cannot tell: the log does not state its units, and its lines depend on them. {} settles it.",
        options);
    found.doubts.push_back(
        {DoubtReason::unit, fmt::format("the log does not state its units; {} settles it", options)});
    found.conclusive = false;
    found.gear_ratio = {};
    found.lines.clear();
    found.searched.reset();
    return found;
}

// Readings as possible as the one taken, of all the logs, each once.
std::vector<OtherReading> open_readings(std::span<const Log> logs) {
    return readings_of(logs, &Layout::assumptions);
}

// What the one that was taken is called: "in rad/s and rad, as assumed".
std::string assumed_reading(std::span<const Log> logs) {
    for (const Log& log : logs) {
        for (const Assumption& one : log.layout.assumptions)
            if (!one.others.empty()) return fmt::format("if it is {}, as assumed", one.assumed);
    }
    for (const Log& log : logs) {
        for (const Assumption& one : log.layout.inferences)
            if (!one.others.empty()) return fmt::format("if it is {} ({})", one.assumed, one.reason);
    }
    return "as read";
}

// Options that settle them, those for what was assumed first.
std::string settling_options(std::span<const Log> logs) {
    std::vector<std::string> options;
    for (const auto list : {&Layout::assumptions, &Layout::inferences}) {
        for (const Log& log : logs) {
            for (const Assumption& one : log.layout.*list) {
                if (one.others.empty()) continue;
                if (std::find(options.begin(), options.end(), one.settle_with) == options.end())
                    options.push_back(one.settle_with);
                for (const OtherReading& other : one.others) {
                    if (std::find(options.begin(), options.end(), other.option) == options.end())
                        options.push_back(other.option);
                }
            }
        }
        if (!options.empty()) break;
    }
    return fmt::format("{}", fmt::join(options, " or "));
}

}  // namespace

std::string reading_doubt(std::span<const Log> logs,
                          const std::function<bool(const OtherReading&)>& may_hold) {
    const std::string rivals = joined(open_readings(logs), ", or if ", [&](const OtherReading& reading) {
        return may_hold(reading) ? reading.words : "";
    });
    if (rivals.empty()) return "";
    return fmt::format("the log does not state its units, and its orders are others if {}; {} settles it",
                       rivals, settling_options(logs));
}

Trace read_otherwise(const Trace& trace, const OtherReading& reading) {
    Trace read = trace;
    for (double& value : read.time_s) value *= reading.time_factor;
    for (double& value : read.velocity_deg_s) value *= reading.velocity_factor;
    for (double& value : read.position_deg) value *= reading.position_factor;
    read.sample_rate = Hertz(trace.sample_rate.value() / reading.time_factor);
    return read;
}

Identification identify_readings(std::span<const Log> logs, const IdentifyOptions& options) {
    Identification taken = identified(logs, options, {});
    std::vector<OtherReading> readings = open_readings(logs);
    const bool open = !readings.empty();
    // What a rule decided is doubted only where nothing came of it.
    if (!taken.gear_ratio.value) {
        for (OtherReading& other : readings_of(logs, &Layout::inferences))
            readings.push_back(std::move(other));
    }
    std::vector<std::pair<OtherReading, Identification>> others;
    for (const OtherReading& reading : readings) {
        Identification other = identified(logs, options, reading);
        const bool matters = open ? !agree(taken, other)
                                  : other.conclusive && other.gear_ratio.value.value_or(0.0) > least_ratio;
        if (matters) others.emplace_back(reading, std::move(other));
    }
    if (others.empty()) return taken;
    return cannot_tell(taken, assumed_reading(logs), others, settling_options(logs));
}

namespace {

std::string gap_in_words(const Diagnosis& diagnosis) {
    if (diagnosis.verdict == DiagnosisVerdict::matches) return "the model matches the log";
    const std::string named = fmt::format("{}", fmt::join(diagnosis.named, ", "));
    return fmt::format("the log is {}{}{}", verdict_name(diagnosis.verdict), named.empty() ? "" : " with ",
                       named);
}

}  // namespace

Diagnosis diagnose_readings(const Model& model, const Log& log, const Log* validation,
                            const DiagnosisOptions& options) {
    const std::span own(&log, 1), other(validation, validation == nullptr ? 0U : 1U);
    const auto under = [&](const OtherReading& reading) {
        const LogsRead first(own, reading), second(other, reading);
        return diagnose(model, first.views.front(), second.views.empty() ? nullptr : &second.views.front(),
                        options);
    };
    Diagnosis taken = under({});
    std::string doubt;
    for (const OtherReading& reading : open_readings(own)) {
        if (reading.changes_side && model.has_gear_ratio()) continue;
        // The joint's motion is then less than the log's by an unknown ratio.
        const Diagnosis then = under(reading.changes_side ? behind_stand_in(reading) : reading);
        if (then.verdict == taken.verdict && then.named == taken.named) continue;
        doubt += fmt::format(". If {}, {}", reading.words, gap_in_words(then));
    }
    if (doubt.empty()) return taken;
    taken.doubt = fmt::format("Cannot tell: {}, {}{}. {} settles it.", assumed_reading(own),
                              gap_in_words(taken), doubt, settling_options(own));
    taken.verdict = DiagnosisVerdict::undecided;
    taken.model = taken.baseline;
    taken.values.clear();
    taken.rounds.clear();
    taken.refused.clear();
    taken.named.clear();
    taken.ambiguous.clear();
    taken.accepted.clear();
    taken.next.clear();
    return taken;
}

// A reading under which something turns with the motor is confirmed by that; where two have it, or none of
// several, the log does not decide which one holds.
MapFit map_readings(std::span<const Log> logs, const GearAccount& gear, Degrees zero,
                    const OtherMotors& others) {
    const auto under = [&](const OtherReading& reading) {
        return fit_ripple_map(LogsRead(logs, reading).views, gear, zero.value());
    };
    MapFit fit = under({});
    const std::string doubt = reading_doubt(logs, [&](const OtherReading& reading) {
        return !reading.changes_side &&
               (fit.finding != MapFinding::mapped || under(reading).finding == MapFinding::mapped);
    });
    if (doubt.empty()) {
        if (others.motors.empty()) return fit;
        return fit_joint_map(LogsRead(logs).views, &gear, others.motors, others.pairs(), zero.value());
    }
    fit.doubt = fmt::format("Cannot tell: {}. {}:", doubt, assumed_reading(logs));
    fit.conclusive = false;
    return fit;
}

void refuse_open_readings(const Log& log) {
    const std::span one(&log, 1);
    const auto open = open_readings(one);
    if (!open.empty())
        raise<DataError>("{}: the log does not state its units: {}, or {}; {} settles it", log.layout.source,
                         assumed_reading(one), open.front().words, settling_options(one));
    if (log.layout.motor_units)
        raise<DataError>(
            "{}: the motion is measured before the gear (stated, named so, or too fast for a joint); use "
            "--gear-ratio 100, or --side joint if it is the joint's",
            log.layout.source);
}

std::string against_ratio(const Identification& found, GearRatio stated) {
    constexpr double rounding = 0.001;
    const GearRatioFit& fit = found.gear_ratio;
    if (fit.contradicted) {
        const std::string probable = joined(fit.candidates, " or ", [](const RatioCandidate& one) {
            return fmt::format("{:.5g}", one.value);
        });
        return fmt::format("the lines of this log contradict the stated gear ratio {:.6g}{}", stated.value(),
                           probable.empty() ? "" : "; probable is " + probable);
    }
    if (!fit.value) return "";
    const double doubt = std::max(fit.ci95_high - *fit.value, rounding * stated.value());
    if (std::abs(*fit.value - stated.value()) <= doubt) return "";
    return fmt::format("--gear-ratio {}: the lines give {:.6g} (95 %: {:.6g} to {:.6g})",
                       shortest(stated.value()), *fit.value, fit.ci95_low, fit.ci95_high);
}

std::string against_gear(std::span<const Log> logs, const GearAccount& gear) {
    const bool enough = std::all_of(
        logs.begin(), logs.end(), [](const Log& log) { return log.trace.size() >= fewest_identify_samples; });
    if (!gear.has_ratio() || !enough) return "";
    IdentifyOptions options;
    options.hint = gear.ratio;
    return against_ratio(identify_readings(logs, options), gear.ratio);
}

namespace {

// The amplitudes are those of estimate_ripple, as everywhere, over the angle of the other motor.
OtherMotorRipple other_ripple(const MapFit& fit, const OtherMotor& motor,
                              std::span<const std::vector<double>> torques_nm) {
    OtherMotorRipple ripple{motor.joint, motor.gear.ratio, {}, fit.doubt};
    std::vector<TraceView> logs = motor.motion;
    for (std::size_t l = 0; l < logs.size(); ++l) logs[l].torque_nm = torques_nm[l];
    std::vector<Order> found;
    for (const MapOrderScore& score : fit.scores)
        if (score.in_map) found.emplace_back(score.order);
    const std::vector<RippleEstimate> estimates = estimate_ripple(logs, motor.gear.ratio, found);
    auto next = estimates.begin();
    for (const MapOrderScore& score : fit.scores) {
        OtherMotorRipple::AtOrder& at = ripple.orders.emplace_back();
        at.order = score.order;
        at.found = score.in_map;
        if (score.in_map) {
            at.amplitude_nm = next->amplitude_nm;
            at.standard_error_nm = next->standard_error_nm;
            ++next;
        } else if (std::isfinite(score.detectable_nm) && score.detectable_nm > 0.0) {
            at.detectable_nm = score.detectable_nm;
        }
    }
    return ripple;
}

// Both splines give lines one output order apart, which segments of eight motor turns cannot separate: they
// are one ripple here, at the order of the stronger one.
std::vector<Order> separable_orders(const Identification& found) {
    std::vector<Order> orders;  // of the strongest line first
    for (const Line& line : found.lines) {
        const auto order = motor_order(line);
        const auto is_near = [&](Order other) {
            return std::abs(other.value() - *order) < ripple_resolution_orders;
        };
        if (order && std::none_of(orders.begin(), orders.end(), is_near)) orders.emplace_back(*order);
    }
    std::sort(orders.begin(), orders.end());
    return orders;
}

}  // namespace

void add_amplitudes(Identification& found, std::span<const Log> logs, std::optional<GearRatio> stated) {
    const bool known = found.gear_ratio.value.has_value();
    if (!found.doubts.empty() || (!known && !stated)) return;
    const std::vector<TraceView> views = LogsRead(logs).views;
    found.by_speed =
        known ? amplitude_by_speed(views, GearRatio(*found.gear_ratio.value), separable_orders(found))
              : amplitude_by_speed(views, *stated, default_orders());
}

Identification identify_among(std::span<const Log> logs, Identification alone, const OtherMotors& others,
                              const IdentifyOptions& options) {
    if (others.motors.empty() || !alone.doubts.empty()) {
        alone.other_motors_not_known = others.not_known;
        return alone;
    }
    const std::vector<TraceView> views = LogsRead(logs).views;
    const std::optional<GearAccount> own = found_gear(alone);
    const MapFit fit = fit_joint_map(views, own ? &*own : nullptr, others.motors, others.pairs());
    Identification found = std::move(alone);
    if (!fit.map.others.empty()) {
        std::vector<Log> less(logs.begin(), logs.end());
        std::vector<std::vector<double>> torques = without_other_motors(views, fit.map, others.motors);
        for (std::size_t l = 0; l < less.size(); ++l) less[l].trace.torque_nm = std::move(torques[l]);
        std::string joint = std::move(found.joint);
        found = identify_readings(less, options);
        add_amplitudes(found, less, options.hint);
        found.joint = std::move(joint);
    }
    for (std::size_t j = 0; j < others.motors.size(); ++j) {
        RippleMap rest = fit.map;
        std::erase_if(rest.others, [&](const RippleMap& one) { return one.joint == others.motors[j].joint; });
        std::vector<std::vector<double>> torques = without_other_motors(views, rest, others.motors);
        for (std::size_t l = 0; l < logs.size() && !rest.orders.empty(); ++l) {
            const std::vector<double> ripple = map_along(rest, views[l]);
            for (std::size_t k = 0; k < ripple.size(); ++k) torques[l][k] -= ripple[k];
        }
        found.other_motors.push_back(other_ripple(fit.others[j], others.motors[j], torques));
    }
    found.other_motors_not_known = others.not_known;
    if (const std::string words = other_motors_sentence(found); !words.empty()) found.verdict += " " + words;
    return found;
}

}  // namespace ripplenotch
