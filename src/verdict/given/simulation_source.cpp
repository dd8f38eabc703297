// SPDX-License-Identifier: MIT
#include "verdict/given/simulation_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <utility>
#include <vector>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/core/spec.hpp"

namespace ripplenotch {
namespace {

// Those of a file of its own; the last ones hold for a column of the log as well.
constexpr Key log_keys[] = {
    {.name = "file", .kind = KeyKind::text, .required = true, .help = "the simulation's log"},
    {.name = "column", .kind = KeyKind::text, .required = true, .help = "of its torque"},
    {.name = "validate", .kind = KeyKind::text, .help = "its log for the validation log"},
    {.name = "align", .choices = "start", .help = "start: both logs begin together"},
    {.name = "scale",
     .kind = KeyKind::number,
     .help = "factor that is known; left out: 1, unless the log shows another"},
    {.name = "delay", .kind = KeyKind::text, .default_text = "0s", .help = "of the column, if it is known"},
    {.name = "position", .kind = KeyKind::text, .help = "column of its position"},
    {.name = "velocity", .kind = KeyKind::text, .help = "column of its velocity"},
};
constexpr Key name_key = {.name = "name", .kind = KeyKind::text, .required = true, .help = "of the column"};
constexpr Key column_keys[] = {name_key, log_keys[4], log_keys[5], log_keys[6], log_keys[7]};

// The cubic through the four samples about a time.
double cubic_at(const std::vector<double>& time_s, const std::vector<double>& value, double at_s) {
    const std::size_t n = time_s.size();
    if (at_s <= time_s.front()) return value.front();
    if (at_s >= time_s.back()) return value.back();
    const auto next =
        static_cast<std::size_t>(std::upper_bound(time_s.begin(), time_s.end(), at_s) - time_s.begin());
    const std::size_t first =
        std::min(next - std::min<std::size_t>(next, 2), n - std::min<std::size_t>(n, 4));
    const std::size_t end = std::min(first + 4, n);
    double sum = 0.0;
    for (std::size_t i = first; i < end; ++i) {
        double weight = 1.0;
        for (std::size_t j = first; j < end; ++j) {
            if (i != j) weight *= (at_s - time_s[j]) / (time_s[i] - time_s[j]);
        }
        sum += weight * value[i];
    }
    return sum;
}

void begin_together(std::vector<double>& time_s, const Log& log) {
    const double ahead_s = log.trace.time_s.front() - time_s.front();
    for (double& time : time_s) time += ahead_s;
}

void refuse_useless(const std::vector<double>& torque_nm, const Log* measured, const std::string& column,
                    const std::string& source) {
    const auto [low, high] = std::minmax_element(torque_nm.begin(), torque_nm.end());
    if (*low == *high)
        raise<DataError>("simulated: '{}' of {} is {:g} Nm throughout; nothing can be compared with it",
                         column, source, *low);
    if (measured != nullptr && torque_nm == measured->trace.torque_nm)
        raise<DataError>("simulated: '{}' is the measured torque of {}", column, source);
}

// Rows that the simulation does not span are as if they were not there.
void keep_within(Log& log, double from_s, double to_s, const std::string& path) {
    Trace& trace = log.trace;
    const auto first =
        std::lower_bound(trace.time_s.begin(), trace.time_s.end(), from_s) - trace.time_s.begin();
    const auto end = std::upper_bound(trace.time_s.begin(), trace.time_s.end(), to_s) - trace.time_s.begin();
    if (first >= end)
        raise<DataError>(
            "simulated: {} spans {:g} to {:g} s and the log {:g} to {:g} s; align=start lets both begin "
            "together",
            path, from_s, to_s, trace.time_s.front(), trace.time_s.back());
    const std::size_t outside = trace.size() - static_cast<std::size_t>(end - first);
    if (outside == 0) return;
    for (auto* column : {&trace.time_s, &trace.velocity_deg_s, &trace.torque_nm, &trace.position_deg}) {
        if (column->empty()) continue;
        *column = std::vector<double>(column->begin() + first, column->begin() + end);
    }
    std::vector<std::size_t> starts;
    for (const std::size_t row : trace.run_starts) {
        if (row > static_cast<std::size_t>(first) && row < static_cast<std::size_t>(end))
            starts.push_back(row - static_cast<std::size_t>(first));
    }
    trace.run_starts = starts;
    log.recording.warnings.push_back(
        {"rows outside the simulation",
         fmt::format("{} rows of the log are outside what {} spans and do not count", outside, path), true});
}

// A scale that is not stated is 1 until something shows another.
GivenTerm term_of(std::vector<double> at_log, const SimulatedTerm& stated) {
    const double deviation = stated.scale ? stated_deviation : std::numeric_limits<double>::infinity();
    return {"simulated", {std::move(at_log)}, {stated.scale.value_or(1.0)}, {deviation}};
}

bool states(const Spec& spec, std::string_view key) {
    return std::any_of(spec.values.begin(), spec.values.end(),
                       [&](const auto& pair) { return pair.first == key; });
}

// A name alone is that of a column; a file is a log without that word, too.
Spec spec_of(std::string_view text) {
    Spec spec = parse_spec(text.starts_with("file=") ? fmt::format("log,{}", text) : std::string(text));
    if (spec.name == "column" || spec.name == "log") return spec;
    if (states(spec, "name") || states(spec, "file") || states(spec, "column"))
        raise<UsageError>("--simulated: '{}' is neither column,name=NAME nor log,file=FILE,column=NAME",
                          text);
    if (std::filesystem::is_regular_file(spec.name))
        raise<UsageError>(
            "--simulated: {} is a file; state which of its columns is the torque: --simulated "
            "log,file={},column=NAME",
            spec.name, spec.name);
    spec.values.emplace_back("name", std::exchange(spec.name, "column"));
    return spec;
}

}  // namespace

ReadOptions with_role(ReadOptions reading, const std::string& role, const std::string& column,
                      std::string_view option) {
    const bool by_place =
        std::any_of(reading.columns.begin(), reading.columns.end(),
                    [](const std::string& entry) { return entry.find('=') == std::string::npos; });
    if (by_place)
        raise<UsageError>(
            "{}: with --columns by place its column cannot be named; name the columns, as in --columns "
            "velocity=dq,torque=tau",
            option);
    std::erase_if(reading.columns, [&](const std::string& entry) { return entry.starts_with(role + "="); });
    reading.columns.push_back(role + "=" + column);
    reading.units.erase(role);
    reading.scales.erase(role);
    return reading;
}

SimulationSource::SimulationSource(std::string_view text, const std::optional<SimulatedTerm>& stated) {
    const Spec spec = spec_of(text);
    const bool own = spec.name == "log";
    const Settings settings("--simulated " + spec.name, spec,
                            own ? std::span<const Key>(log_keys) : std::span<const Key>(column_keys));
    term_.column = settings.text(own ? "column" : "name");
    if (own) file_ = settings.text("file");
    if (own && settings.has("validate")) validation_file_ = settings.text("validate");
    align_start_ = own && settings.has("align");
    if (settings.has("position")) position_ = settings.text("position");
    if (settings.has("velocity")) velocity_ = settings.text("velocity");
    if (!own && position_ && !velocity_)
        raise<UsageError>(
            "--simulated: position={} needs velocity= too: a position is checked against the velocity that "
            "it is read with, and that of the log is another motion",
            *position_);
    if (stated) {
        if (states(spec, "scale") || states(spec, "delay"))
            raise<UsageError>("--simulated: the model states its scale and delay; change them there");
        states_delay_ = true;
        const std::string column = std::exchange(term_.column, {});
        term_ = *stated;
        term_.column = column;
        return;
    }
    if (settings.has("scale")) term_.scale = settings.number("scale");
    states_delay_ = states(spec, "delay");
    const std::string delay = settings.text("delay");
    if (delay == "fit")
        raise<UsageError>(
            "--simulated: delay=fit is not needed: a delay is one of the effects that are tried; leave it "
            "out");
    term_.delay_s = parse_quantity(delay, Dimension::time, "--simulated: delay");
}

GivenTerm SimulationSource::read(const ReadOptions& reading, const std::string& path, Log& log) const {
    if (!file_ && path == "-")
        raise<UsageError>(
            "--simulated column,...: standard input cannot be read twice; give the log as a file");
    return from(reading, file_.value_or(path), log);
}

GivenTerm SimulationSource::read_validation(const ReadOptions& reading, const std::string& path,
                                            Log& log) const {
    if (file_ && !validation_file_)
        raise<UsageError>(
            "--simulated log,...: with --validate the simulation of that log is needed too: validate=FILE");
    return from(reading, file_ ? *validation_file_ : path, log);
}

ReadOptions SimulationSource::reading_of(ReadOptions reading) const {
    if (!file_) return with_role(std::move(reading), "torque", term_.column, "--simulated");
    // Its own layout: of what is said about the log only the units of these columns hold.
    ReadOptions own;
    own.columns = {"torque=" + term_.column};
    own.gear_ratio = reading.gear_ratio;
    own.takes_motor_units = true;
    if (position_) own.columns.push_back("position=" + *position_);
    if (velocity_) own.columns.push_back("velocity=" + *velocity_);
    for (const std::string& column : {term_.column, position_.value_or(""), velocity_.value_or("")}) {
        if (const auto unit = reading.units.find(column); unit != reading.units.end())
            own.units.insert(*unit);
        if (const auto scale = reading.scales.find(column); scale != reading.scales.end())
            own.scales.insert(*scale);
    }
    return own;
}

SetupContext SimulationSource::names() const {
    SetupContext context;
    context.torque_column = term_.column;
    if (position_) context.position_column = *position_;
    if (velocity_) context.velocity_column = *velocity_;
    return context;
}

SimulatedMotion SimulationSource::read_motion(const ReadOptions& reading, const std::string& path,
                                              const Log& log) const {
    ReadOptions own = reading_of(reading);
    own.needs_velocity = false;
    if (!file_ && position_) own = with_role(std::move(own), "position", *position_, "--simulated");
    if (!file_ && velocity_) own = with_role(std::move(own), "velocity", *velocity_, "--simulated");
    const Trace trace = read_log(file_.value_or(path), own).trace;
    SimulatedMotion motion{trace.time_s, {}, {}, trace.torque_nm};
    if (file_ || position_) motion.position_deg = trace.position_deg;
    const bool has_velocity = std::any_of(trace.velocity_deg_s.begin(), trace.velocity_deg_s.end(),
                                          [](double each) { return std::isfinite(each); });
    if (has_velocity && (file_ || velocity_)) motion.velocity_deg_s = trace.velocity_deg_s;
    if (align_start_) begin_together(motion.time_s, log);
    return motion;
}

SimulatedMotion SimulationSource::read_motion_at(const ReadOptions& reading, const std::string& path,
                                                 const Log& log) const {
    if (!file_ && !position_ && !velocity_) return {};
    SimulatedMotion motion = read_motion(reading, path, log);
    for (std::vector<double>* series : {&motion.position_deg, &motion.velocity_deg_s, &motion.torque_nm}) {
        if (series->empty()) continue;
        std::vector<double> at_log;
        for (const double t : log.trace.time_s)
            at_log.push_back(cubic_at(motion.time_s, *series, t + term_.delay_s));
        *series = std::move(at_log);
    }
    motion.time_s = log.trace.time_s;
    return motion;
}

GivenTerm SimulationSource::from(ReadOptions reading, const std::string& path, Log& log) const {
    reading = reading_of(std::move(reading));
    if (file_) reading.needs_velocity = false;  // its torque and its times are all that is compared
    const Log simulated = read_log(path, reading);
    refuse_useless(simulated.trace.torque_nm, file_ ? nullptr : &log, term_.column, path);
    std::vector<double> time_s = simulated.trace.time_s;
    if (align_start_) begin_together(time_s, log);
    if (!file_ && simulated.trace.size() != log.trace.size())
        raise<DataError>("simulated: '{}' of {} has {} rows that can be read, the log {}", term_.column, path,
                         simulated.trace.size(), log.trace.size());
    if (file_) keep_within(log, time_s.front() - term_.delay_s, time_s.back() - term_.delay_s, path);
    if (term_.delay_s == 0.0 && !file_) return term_of(simulated.trace.torque_nm, term_);
    std::vector<double> at_log;
    for (const double t : log.trace.time_s)
        at_log.push_back(cubic_at(time_s, simulated.trace.torque_nm, t + term_.delay_s));
    return term_of(std::move(at_log), term_);
}

}  // namespace ripplenotch
