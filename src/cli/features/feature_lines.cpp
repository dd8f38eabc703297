// SPDX-License-Identifier: MIT
#include "cli/features/feature_lines.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <filesystem>

#include "cli/readings/readings.hpp"
#include "cli/readings/side_column.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/inputs_read.hpp"
#include "ripplenotch/core/version.hpp"
#include "ripplenotch/fleet/features.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t most_rows_looked_at = std::size_t{1} << 17U;
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

std::string date_of_file(const std::string& path) {
    const auto written = std::filesystem::last_write_time(path);
    const auto since = std::chrono::file_clock::to_sys(written).time_since_epoch();
    return date_text(static_cast<double>(std::chrono::duration_cast<std::chrono::seconds>(since).count()));
}

void take_date(const ManifestEntry& entry, const Log& log, const FeatureWork& work, FeatureLine& line) {
    const auto named = work.pattern ? work.pattern->match(entry.log) : std::nullopt;
    if (named) line.robot = named->robot;
    if (entry.robot) line.robot = *entry.robot;
    const auto in_log = date_in(log);
    if (entry.date) {
        line.date = entry.date, line.date_source = "manifest";
    } else if (named) {
        line.date = named->date, line.date_source = "name";
    } else if (work.pattern) {
        line.date_source = fmt::format("the name does not fit '{}'", work.pattern->text());
    } else if (in_log) {
        line.date = in_log, line.date_source = "log";
    } else if (work.date_from_file && entry.log != "-") {
        line.date = date_of_file(entry.log), line.date_source = "file";
    } else {
        line.date_source = "the log's clock has no day; --date-from-name or --date-from-file tell it";
    }
}

void take_temperature(const ManifestEntry& entry, const FeatureWork& work, FeatureLine& line) {
    if (entry.temperature_degc) {
        line.temperature_degc = entry.temperature_degc, line.temperature_source = "manifest";
    } else if (work.temperature_degc) {
        line.temperature_degc = work.temperature_degc, line.temperature_source = "--temperature";
    } else if (work.temperature_column) {
        line.temperature_degc = mean_of_side_column(entry.log, *work.temperature_column, line.joint,
                                                    work.read, most_rows_looked_at);
        line.temperature_source = "column " + *work.temperature_column;
    } else {
        line.temperature_source = "nobody states it; --temperature names a column or a number";
    }
}

// Torque over a speed that may be in deg/s as well as in rad/s is no number to be kept.
void refuse_open_readings(const Log& log) {
    const std::span one(&log, 1);
    const auto open = open_readings(one);
    if (!open.empty())
        raise<DataError>("{}: the log does not say its units: {}, or {}; {} settles it", log.layout.source,
                         assumed_reading(one), open.front().words, settling_options(one));
    if (log.layout.motor_units)
        raise<DataError>("{}: the motion is measured before the gear; --gear-ratio tells the joint's",
                         log.layout.source);
}

FeatureLine line_of(const Log& log, const ManifestEntry& entry, const FeatureWork& work, FeatureLine line) {
    refuse_open_readings(log);
    if (log.trace.size() < fewest_identify_samples)
        raise<DataError>("{}: {} samples; features need at least 200", log.layout.source, log.trace.size());
    take_date(entry, log, work, line);
    take_temperature(entry, work, line);
    line.rows = log.recording.rows();
    if (!log.trace.time_s.empty()) line.duration_s = log.trace.time_s.back() - log.trace.time_s.front();
    IdentifyOptions identify;
    if (work.gear) identify.hint = work.gear->ratio;
    const Identification found = identify_readings({&log, 1}, identify);
    Features features = features_of(log.trace.view(), found, work.gear);
    line.mix = features.mix;
    line.descriptors = std::move(features.descriptors);
    return line;
}

std::vector<Log> read_logs(const std::string& path, const ReadOptions& read) {
    if (read.joint == "all") return read_joints_in_part(path, read, most_rows_looked_at);
    std::vector<Log> logs;
    logs.push_back(read_log_in_part(path, read, most_rows_looked_at));
    return logs;
}

}  // namespace

std::vector<FeatureLine> feature_lines(const ManifestEntry& entry, const FeatureWork& work) {
    FeatureLine head;
    head.log = entry.log;
    head.version = version();
    head.robot = entry.robot.value_or("");
    std::vector<FeatureLine> lines;
    try {
        std::vector<Log> logs = read_logs(entry.log, work.read);
        if (entry.log != "-") head.sha256 = sha256_as_read(entry.log);
        for (const Log& log : logs) {
            FeatureLine line = head;
            line.joint = log.trace.joint;
            for (const LogWarning& warning : log.recording.warnings) say(work.common, warning.text);
            try {
                lines.push_back(line_of(log, entry, work, line));
            } catch (const MemoryError&) {
                throw;
            } catch (const Error& error) {
                lines.push_back(failed_line(line, error));
            }
        }
        if (logs.empty()) raise<DataError>("{}: no joint has a motion and a torque", entry.log);
    } catch (const MemoryError&) {
        throw;
    } catch (const Error& error) {
        lines.push_back(failed_line(head, error));
    }
    return lines;
}

}  // namespace ripplenotch
