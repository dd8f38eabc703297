// SPDX-License-Identifier: MIT
#include "cli/readings/readings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "cli/gear/gear_choice.hpp"
#include "core/text/lower_case.hpp"
#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/document/map_json.hpp"
#include "ripplenotch/log/log.hpp"

namespace ripplenotch {

namespace {

constexpr std::string_view remedy = "state it in the method: temperature=31";

std::string value_of(const Spec& spec, std::string_view key) {
    const auto at = std::find_if(spec.values.begin(), spec.values.end(),
                                 [key](const auto& entry) { return entry.first == key; });
    return at == spec.values.end() ? "" : at->second;
}

std::string named_for(std::string column, const std::string& joint) {
    if (const std::size_t at = column.find(joint_mark); at != std::string::npos)
        column.replace(at, joint_mark.size(), joint);
    return column;
}

// The column is read in the place of the torque.
ReadOptions beside(std::string& column, const std::string& joint, ReadOptions read) {
    column = named_for(column, joint);
    std::erase_if(read.columns, [](const std::string& entry) { return entry.starts_with("torque="); });
    read.columns.push_back("torque=" + column);
    read.units["torque"] = "Nm";  // its numbers as they are
    if (joint.empty())
        read.joint.reset();
    else
        read.joint = joint;
    return read;
}

std::string joint_of(const RippleMap& map, const ReadOptions& read) {
    return read.joint.value_or(names_joint(map.temperature_column) ? map.joint : "");
}

ReadOptions held(ReadOptions read) {
    read.hold_bad_values = true;
    return read;
}

std::string held_in_words(const std::string& log, const std::string& column, std::size_t cells) {
    return fmt::format("{}: column '{}': {} {} without a temperature; the row before counts", log, column,
                       cells, cells == 1 ? "cell" : "cells");
}

}  // namespace

std::vector<double> side_column(const std::string& path, std::string column, const std::string& joint,
                                ReadOptions read, std::size_t most_rows) {
    return read_log_in_part(path, beside(column, joint, std::move(read)), most_rows).trace.torque_nm;
}

void require_beside(const std::vector<double>& values, const Trace& motion, const std::string& path,
                    const std::string& column) {
    if (values.size() != motion.size())
        raise<DataError>("{}: column '{}' has {} numbers at {} rows of the motion", path, column,
                         values.size(), motion.size());
}

double mean_of_side_column(const std::string& path, const std::string& column, const std::string& joint,
                           const ReadOptions& read, std::size_t most_rows) {
    const std::vector<double> values = side_column(path, column, joint, read, most_rows);
    return std::accumulate(values.begin(), values.end(), 0.0) /
           static_cast<double>(std::max<std::size_t>(values.size(), 1));
}

std::vector<double> held_side_column(const std::string& path, std::string column, const std::string& joint,
                                     const ReadOptions& read, std::vector<std::string>& notes) {
    Log side = read_log_in_part(path, held(beside(column, joint, read)));
    if (side.held_bad_values > 0) notes.push_back(held_in_words(path, column, side.held_bad_values));
    return std::move(side.trace.torque_nm);
}

std::string at_rows_temperature(const std::string& method, double degc) {
    return fmt::format("{},temperature={},temperature-of=rows", method,
                       shortest(std::round(1000.0 * degc) / 1000.0));
}

bool follows_temperature(const Contender& method) {
    return method.map != nullptr && method.map->form.by_temperature &&
           method.settings.has("temperature-of") && method.settings.text("temperature-of") == "rows";
}

std::string at_log_temperature(const std::string& method, const std::string& log, const ReadOptions& read) {
    if (names_joint(method)) return method;
    const Spec spec = parse_spec(method);
    const std::string path = value_of(spec, "map");
    if (path.empty() || !value_of(spec, "temperature").empty() || !is_map(path)) return method;
    const RippleMap map = load_map(path).map;
    if (!map.form.by_temperature) return method;
    const std::string& column = map.temperature_column;
    if (log == "-")
        raise<UsageError>(
            "method {}: {} depends on the joint's temperature ('{}'), and standard input cannot be "
            "read twice; {}",
            spec.name, path, column, remedy);
    const std::string shown = named_for(column, joint_of(map, read));
    const auto reader = open_log(log, read);
    const auto& columns = reader->layout().columns;
    if (std::none_of(columns.begin(), columns.end(), [&](const auto& one) { return one.name == shown; }))
        raise<DataError>("{}: read no column '{}', expected the temperature that {} depends on; {}", log,
                         shown, path, remedy);
    return at_rows_temperature(method, mean_of_side_column(log, column, joint_of(map, read), held(read)));
}

FollowedRows::FollowedRows(const std::string& path, std::string column, const ReadOptions& side)
    : path_(path), column_(std::move(column)), reader_(open_log(path, side)) {}

std::span<const double> FollowedRows::next(std::size_t count) {
    values_.clear();
    while (values_.size() < count) {
        const std::vector<double>& column = block_.joints.front().torque_nm;
        if (used_ == column.size()) {
            used_ = 0;
            if (!reader_->next(block_))
                raise<DataError>(
                    "{}: column '{}' ends before the log does; read a copy that nobody writes to", path_,
                    column_);
            held_ += block_.held_bad_values;
            continue;
        }
        const std::size_t taken = std::min(count - values_.size(), column.size() - used_);
        const auto from = column.begin() + static_cast<std::ptrdiff_t>(used_);
        values_.insert(values_.end(), from, from + static_cast<std::ptrdiff_t>(taken));
        used_ += taken;
    }
    return values_;
}

std::vector<std::string> FollowedRows::notes() const {
    return held_ == 0 ? std::vector<std::string>{} : std::vector{held_in_words(path_, column_, held_)};
}

std::unique_ptr<FollowedRows> followed_rows(const Contender& method, const std::string& log,
                                            const ReadOptions& read) {
    if (!follows_temperature(method)) return nullptr;
    std::string column = method.map->temperature_column;
    const ReadOptions side = held(beside(column, joint_of(*method.map, read), read));
    return std::make_unique<FollowedRows>(log, column, side);
}

std::vector<double> followed_values(const Contender& method, const std::string& log, const ReadOptions& read,
                                    std::vector<std::string>& notes) {
    if (!follows_temperature(method)) return {};
    return held_side_column(log, method.map->temperature_column, joint_of(*method.map, read), read, notes);
}

namespace {

}  // namespace

ArmLog ArmReading::view() const {
    ArmLog arm;
    for (const Log& log : logs) {
        arm.joints.push_back(log.trace.view());
        arm.has_torque.push_back(log.layout.chosen.torque.has_value());
    }
    return arm;
}

std::size_t ArmReading::find(const Chain& chain, const std::string& joint) const {
    for (std::size_t j = 0; j < names.size(); ++j)
        if (lower_case(names[j]) == lower_case(joint)) return j;
    std::vector<std::string> known;
    for (std::size_t j = 0; j < chain.size(); ++j) {
        known.push_back(chain.joints[j].name);
        if (lower_case(known.back()) == lower_case(joint)) return j;
    }
    raise<UsageError>("arm: '{}' is no joint of {}; {}{}", joint, chain.source, joint_list(chain),
                      did_you_mean(joint, known));
}

ArmReading read_arm(const std::string& path, const ReadOptions& options, std::size_t most_rows,
                    const Chain& chain, const StatedJoints& stated) {
    ReadOptions motion = options;
    motion.torque_of_each = false;
    std::vector<Log> all = read_joints_at_once_in_part(path, motion, most_rows);
    std::vector<std::string> there;
    for (const Log& log : all) there.push_back(log.trace.joint);
    const std::string source = all.front().layout.source;
    ArmReading reading{{}, match_joints(chain, there, stated, source), {}};
    for (const std::size_t place : reading.match.of) {
        if (!all[place].trace.view().has_position()) {
            raise<UsageError>(
                "arm: {} has the velocity of '{}' and not its position; gravity depends on it and its "
                "integral "
                "does not tell from where",
                source, there[place]);
        }
        reading.names.push_back(there[place]);
        reading.logs.push_back(std::move(all[place]));
    }
    return reading;
}

namespace {

// What a log itself says against believing what identify finds in it.

// Position over velocity and time is known within 5 % where it is stated at all. A scale that is off by less
// moves a gear ratio by as little; the fit of the ratio speaks of it.
constexpr double agreement = 0.05;
constexpr double widest_clock = 5.0;  // no clock is off by more; a unit or a side is

}  // namespace

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
                 "in {} the position changes {:.4g} times as much as velocity and time say, so {}",
                 log.layout.source, size,
                 clock ? fmt::format("the clock or a unit is wrong: --sample-rate {:.4g}Hz would mend "
                                     "the clock, --unit the velocity or the position",
                                     log.recording.clock.nominal_rate.value() / reading.time_factor / size)
                       : "a unit is wrong, or one of the two is the motor's: --unit would mend it")}};
}

namespace {

/// The ratio that motion of the motor's shaft is divided by where nobody knows the real one, so that its
/// lines stand where those of a joint would.
constexpr double stand_in_ratio = 100.0;

constexpr double same_ratio = 0.02;  // by hand
constexpr double least_ratio = 3.0;  // less is no gear: what was logged turns with the motor

std::string lower_first(std::string text) {
    // "Ripple", "No ripple"; not "UR5e ...".
    if (text.size() > 1 && std::islower(static_cast<unsigned char>(text[1])) != 0)
        text[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(text[0])));
    while (!text.empty() && text.back() == '.') text.pop_back();
    return text;
}

// What tells one reading's verdict from another's: up to the ratio's error. The notes have it whole. That one
// of them cannot tell is said in other words than that nobody can.
std::string briefly(const std::string& verdict) {
    constexpr std::string_view doubtful = "Cannot tell the gear ratio: ";
    if (verdict.starts_with(doubtful))
        return "the gear ratio is open: " + briefly(verdict.substr(doubtful.size()));
    return lower_first(verdict.substr(0, std::min(verdict.find(';'), verdict.find(" (95 %)"))));
}

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
        line.could_be.clear();
        if (line.kind == LineKind::order)
            lines += fmt::format("{}{:.4g} ({:.2g} Nm)", lines.empty() ? "" : ", ", *line.order,
                                 line.amplitude_nm);
    }
    found.grounds.slowest_deg_s *= ratio;
    found.grounds.fastest_deg_s *= ratio;
    found.grounds.sweep_turns *= ratio;
    found.gear_ratio = {};
    found.conclusive = false;
    found.verdict = lines.empty()
                        ? "Cannot tell: the motion is measured before the gear and its ratio is not known; "
                          "--gear-ratio settles it."
                        : fmt::format(
                              "Cannot tell the gear ratio: the motion is measured before the gear. Ripple at "
                              "{} cycles per turn of the motor; --gear-ratio settles it.",
                              lines);
    return found;
}

Identification identified(std::span<const Log> logs, const IdentifyOptions& options,
                          const OtherReading& reading) {
    const bool motor = in_motor_units(logs) != reading.changes_side;
    OtherReading read = reading;
    if (motor) {
        read.velocity_factor /= stand_in_ratio;
        read.position_factor /= stand_in_ratio;
    }
    const bool as_taken =
        read.time_factor == 1.0 && read.velocity_factor == 1.0 && read.position_factor == 1.0;
    std::vector<Trace> traces;
    std::vector<TraceView> views;
    for (const Log& log : logs) {
        if (!as_taken) traces.push_back(read_otherwise(log.trace, read));
    }
    for (std::size_t i = 0; i < logs.size(); ++i)
        views.push_back(as_taken ? logs[i].trace.view() : traces[i].view());
    IdentifyOptions doubting = options;
    for (const Log& log : logs) {
        for (Doubt& doubt : log_doubts(log, read)) doubting.doubts.push_back(std::move(doubt));
    }
    Identification found = identify(views, doubting);
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
    if (a.finding == RippleFinding::nothing && b.finding == RippleFinding::nothing) return true;
    if (a.conclusive != b.conclusive || a.gear_ratio.value.has_value() != b.gear_ratio.value.has_value())
        return false;
    if (a.gear_ratio.value) return std::abs(*a.gear_ratio.value / *b.gear_ratio.value - 1.0) < same_ratio;
    const auto first = stated_order(a), second = stated_order(b);
    return first && second && std::abs(*first - *second) <= same_ratio * *first;
}

Identification cannot_tell(Identification found, const std::string& assumed,
                           const std::vector<std::pair<OtherReading, Identification>>& others,
                           const std::string& options) {
    std::string verdict = fmt::format("Cannot tell: {}, {}", assumed, briefly(found.verdict));
    for (const auto& [reading, other] : others) {
        verdict += fmt::format("; if {}, {}", reading.words, briefly(other.verdict));
        found.notes.push_back(fmt::format("if {} ({}): {}", reading.words, reading.option, other.verdict));
    }
    found.notes.insert(found.notes.end() - static_cast<std::ptrdiff_t>(others.size()),
                       fmt::format("{}: {}", assumed, found.verdict));
    found.verdict = fmt::format("{}; {} settles it.", verdict, options);
    found.doubts.push_back(
        {DoubtReason::unit, fmt::format("the log does not say its units; {} settles it", options)});
    found.conclusive = false;
    found.gear_ratio = {};
    found.lines.clear();
    found.searched.reset();
    return found;
}

}  // namespace

std::vector<OtherReading> open_readings(std::span<const Log> logs) {
    return readings_of(logs, &Layout::assumptions);
}

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

std::string reading_doubt(std::span<const Log> logs,
                          const std::function<bool(const OtherReading&)>& may_hold) {
    std::string rivals;
    for (const OtherReading& reading : open_readings(logs)) {
        if (may_hold(reading)) rivals += (rivals.empty() ? "if " : ", or if ") + reading.words;
    }
    if (rivals.empty()) return "";
    return fmt::format("the log does not say its units, and its orders are others {}; {} settles it", rivals,
                       settling_options(logs));
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
    const std::string named = fmt::format("{}", fmt::join(diagnosis.named, ", "));
    return fmt::format("the log is {}{}{}", verdict_name(diagnosis.verdict), named.empty() ? "" : " with ",
                       named);
}

}  // namespace

Diagnosis diagnose_readings(const Model& model, const Log& log, const Log* validation,
                            const DiagnosisOptions& options) {
    const auto under = [&](const OtherReading& reading) {
        const Trace read = read_otherwise(log.trace, reading);
        const Trace second = validation == nullptr ? Trace{} : read_otherwise(validation->trace, reading);
        const TraceView view = second.view();
        return diagnose_in_full(model, read.view(), validation == nullptr ? nullptr : &view, options);
    };
    const TraceView other = validation == nullptr ? TraceView{} : validation->trace.view();
    Diagnosis taken =
        diagnose_in_full(model, log.trace.view(), validation == nullptr ? nullptr : &other, options);
    std::string doubt;
    for (const OtherReading& reading : open_readings({&log, 1})) {
        if (reading.changes_side) continue;
        const Diagnosis then = under(reading);
        if (then.verdict == taken.verdict && then.named == taken.named) continue;
        doubt += fmt::format("; if {}, {}", reading.words, gap_in_words(then));
    }
    if (doubt.empty()) return taken;
    taken.doubt = fmt::format("Cannot tell: {}, {}{}; {} settles it.", assumed_reading({&log, 1}),
                              gap_in_words(taken), doubt, settling_options({&log, 1}));
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

}  // namespace ripplenotch
