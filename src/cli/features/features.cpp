// SPDX-License-Identifier: MIT
// ripplenotch features: what one log tells of each of its joints, in one line, for one log or a million.

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "cli/command.hpp"
#include "cli/options/joint_runs.hpp"
#include "cli/options/options.hpp"
#include "cli/talk.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/progress.hpp"
#include "ripplenotch/document/results.hpp"
#include "ripplenotch/fleet/features.hpp"
#include "ripplenotch/fleet/trend.hpp"
#include "ripplenotch/verdict/gear_choice.hpp"
#include "ripplenotch/verdict/readings.hpp"

namespace ripplenotch {

namespace {

// All lines of one log; whatever is wrong with it is a line, too.

constexpr std::size_t max_rows_looked_at = std::size_t{1} << 17U;
constexpr double first_stamp_s = 946684800.0, last_stamp_s = 4102444800.0;  // of 2000 and 2100

FeatureLine failed_line(FeatureLine line, const Error& error) {
    line.error = error.what();
    // The library knows no file.
    if (line.error.find(line.log) == std::string::npos)
        line.error = fmt::format("{}: {}", line.log, line.error);
    line.error_code = static_cast<int>(error.code());
    return line;
}

// A stamp that counts from 1970, or is a text with a day.
std::optional<std::string> date_in(const Log& log) {
    const auto& time = log.layout.chosen.time;
    if (!time || log.layout.time_origin == 0) return std::nullopt;
    const double seconds = static_cast<double>(log.layout.time_origin) * log.layout.columns[*time].factor;
    if (!(seconds >= first_stamp_s && seconds < last_stamp_s)) return std::nullopt;
    return date_text(seconds);
}

/// A request whose words were understood, for all its logs.
struct FeatureWork {
    CommonOptions common;
    ReadOptions read;
    std::optional<GearAccount> gear;
    std::optional<NamePattern> pattern;
    std::optional<double> temperature_degc;         ///< stated for all logs
    std::optional<std::string> temperature_column;  ///< with {joint} in the place of a joint's name
};

void take_date(const std::string& path, const Log& log, const FeatureWork& work, FeatureLine& line) {
    if (!work.pattern) {
        line.date = date_in(log);
        line.date_source = line.date ? "log" : "the log's clock has no day; --date-from-name supplies it";
    } else if (const auto named = work.pattern->match(path)) {
        line.robot = named->robot;
        line.date = named->date, line.date_source = "name";
    } else {
        line.date_source = fmt::format("the name does not fit '{}'", work.pattern->text());
    }
}

// The numbers of a column as they stand in the log, at the rows at which read_log_in_part gives the joint's
// motion. {joint} in its name stands for the joint's.
std::vector<double> read_column(const std::string& path, std::string column, const std::string& joint,
                                ReadOptions read, std::size_t most_rows) {
    if (const std::size_t at = column.find(joint_mark); at != std::string::npos)
        column.replace(at, joint_mark.size(), joint);
    // The column is read in the place of the torque.
    std::erase_if(read.columns, [](const std::string& entry) { return entry.starts_with("torque="); });
    read.columns.push_back("torque=" + column);
    read.units["torque"] = "Nm";
    read.scales.erase("torque");
    read.joint = joint.empty() ? std::nullopt : std::optional(joint);
    return read_log_in_part(path, read, most_rows).trace.torque_nm;
}

void take_temperature(const std::string& path, const FeatureWork& work, FeatureLine& line) {
    if (work.temperature_degc) {
        line.temperature_degc = work.temperature_degc, line.temperature_source = "--temperature";
    } else if (work.temperature_column) {
        const std::vector<double> degc =
            read_column(path, *work.temperature_column, line.joint, work.read, max_rows_looked_at);
        line.temperature_degc = std::accumulate(degc.begin(), degc.end(), 0.0) /
                                static_cast<double>(std::max<std::size_t>(degc.size(), 1));
        line.temperature_source = "column " + *work.temperature_column;
    } else {
        line.temperature_source = "not stated; --temperature names a column or a number";
    }
}

FeatureLine line_of(const Log& log, const std::string& path, const FeatureWork& work, FeatureLine line) {
    refuse_open_readings(log);  // torque over a speed in deg/s or rad/s is no number to be kept
    if (log.trace.size() < fewest_identify_samples)
        raise<DataError>("{}: {} samples; features need at least 200", log.layout.source, log.trace.size());
    take_date(path, log, work, line);
    take_temperature(path, work, line);
    line.rows = log.recording.rows();
    if (!log.trace.time_s.empty()) line.duration_s = log.trace.time_s.back() - log.trace.time_s.front();
    IdentifyOptions identify;
    if (work.gear && work.gear->has_ratio()) identify.hint = work.gear->ratio;
    const Identification found = identify_readings({&log, 1}, identify);
    Features features = features_of(log.trace.view(), found, work.gear);
    line.mix = features.mix;
    line.descriptors = std::move(features.descriptors);
    return line;
}

// One line a joint of the log, in the log's order. Errors of the log are lines with an error; only what is
// no matter of one log is thrown.
std::vector<FeatureLine> feature_lines(const std::string& path, const FeatureWork& work) {
    FeatureLine head;
    head.log = path;
    head.version = version();
    std::vector<FeatureLine> lines;
    try {
        std::vector<Log> logs = read_joints_in_part(path, work.read, max_rows_looked_at);
        if (path != "-") head.sha256 = sha256_as_read(path);
        for (const Log& log : logs) {
            FeatureLine line = head;
            line.joint = log.trace.joint;
            for (const LogWarning& warning : log.recording.warnings) say(work.common, warning.text);
            try {
                lines.push_back(line_of(log, path, work, line));
            } catch (const Error& error) {
                lines.push_back(failed_line(line, error));
            }
        }
        if (logs.empty()) raise<DataError>("{}: no joint has a motion and a torque", path);
    } catch (const Error& error) {
        lines.push_back(failed_line(head, error));
    }
    return lines;
}

struct FeatureRequest {
    CommonOptions common;
    ReadOptions log;
    GearOptions gear;
    std::vector<std::string> logs;
    std::optional<std::string> date_from_name, temperature;
    bool merge = false;
};

// Throws UsageError.
FeatureWork work_of(const FeatureRequest& request) {
    FeatureWork work;
    work.common = request.common;
    work.gear = GearChoice(request.gear).of();
    work.read = read_options(request.log, work.gear);
    work.read.takes_motor_units = true;
    if (request.date_from_name) work.pattern.emplace(*request.date_from_name);
    if (request.temperature) {
        work.temperature_degc = parse_number(*request.temperature);
        if (!work.temperature_degc) work.temperature_column = *request.temperature;
        const double degc = work.temperature_degc.value_or(0.0);
        if (!(degc > -274.0 && degc < 1000.0))
            raise<UsageError>("--temperature {} is no temperature in degrees Celsius", shortest(degc));
    }
    return work;
}

// Throws DataError for a line that is none, and for a joint of a log that stands there twice.
Answer merge_lines(const FeatureRequest& request) {
    std::map<std::pair<std::string, std::string>, const std::string*> seen;
    std::string text;
    std::size_t lines = 0, failed = 0;
    for (const std::string& path : request.logs) {
        for (const FeatureLine& line : feature_lines_from_text(read_all(path), input_name(path))) {
            const auto [before, is_new] = seen.try_emplace({line.log, line.joint}, &path);
            if (!is_new)
                raise<DataError>("{}: joint '{}' of {} stands in {} already; merge each line once", path,
                                 line.joint, line.log, *before->second);
            ++lines;
            failed += line.failed() ? 1 : 0;
            text += feature_line_text(line);
        }
    }
    if (failed > 0)
        warn(request.common,
             fmt::format("{} of {} lines have an error instead of descriptors", failed, lines));
    return {.text = text, .kind = Answer::Text::bytes};
}

Answer run_features(FeatureRequest& request) {
    check_output_name(request.common.output, "lines of features", ".ndjson .jsonl .txt");
    if (request.merge) return merge_lines(request);
    const FeatureWork work = work_of(request);
    const std::size_t logs = request.logs.size();
    std::string text;
    std::size_t failed = 0;
    Progress::current().begin("reading", "logs", logs > 1 ? logs : 0);
    for (const std::string& path : request.logs) {
        for (const FeatureLine& line : feature_lines(path, work)) {
            if (line.failed()) {
                ++failed;
                warn(request.common, line.error);
            }
            text += feature_line_text(line);
        }
        if (logs > 1) Progress::current().add(1);
    }
    if (failed > 0 && (logs > 1 || failed > 1))
        warn(request.common, fmt::format("{} of the lines have an error instead of descriptors", failed));
    return {.text = text, .kind = Answer::Text::bytes, .code = failed > 0 ? ExitCode::data : ExitCode::done};
}

std::function<Answer()> attach_features(Options& options) {
    const auto request = std::make_shared<FeatureRequest>();
    options.arguments("LOG", request->logs, true, "logs, in any number");
    attach_gear(options, request->gear);
    options.text("--date-from-name", request->date_from_name, "PATTERN",
                 "date and robot from a log's name: %Y %m %d %H %M %S, {robot}, *, ?");
    options.text("--temperature", request->temperature, "COLUMN",
                 "the joint's temperature: a column in degrees Celsius, {joint} in it for a joint's name, or "
                 "a number");
    options.flag("--merge", request->merge, "put files of lines together; each LOG is one");
    attach_log(options, request->log);
    attach_output(options, request->common.output, "where the lines go; - is standard output");
    attach_json(options, request->common, "as without it: one JSON object a line");
    attach_manner(options, request->common);
    return [request] { return run_features(*request); };
}

}  // namespace

const Command commands::features{
    .name = "features",
    .summary = "descriptors of each joint of a log in one line: ratio, ripple, friction, lost motion",
    .description =
        "A line for each log and joint with its descriptors and their intervals, for one log or for a "
        "fleet.\nWhat a log does not determine is null, with the reason. A log that cannot be read is a line "
        "with its error; exit code 3\nreports that there was one.\nExample: ripplenotch features logs/*.csv "
        "--gear-ratio 100 --date-from-name '*_%Y-%m-%d.csv' -o all.ndjson",
    .attach = attach_features,
};

}  // namespace ripplenotch
