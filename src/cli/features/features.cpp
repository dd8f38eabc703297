// SPDX-License-Identifier: MIT
// ripplenotch features: what one log tells of each of its joints, in one line, for one log or a million.

#include "cli/features/features.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/command.hpp"
#include "cli/options/options.hpp"
#include "cli/options/verdict_options.hpp"
#include "cli/talk.hpp"
#include "core/process/two_cores.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/progress.hpp"
#include "ripplenotch/document/features_json.hpp"
#include "ripplenotch/fleet/features.hpp"
#include "ripplenotch/fleet/shards.hpp"
#include "ripplenotch/verdict/gear_choice.hpp"
#include "ripplenotch/verdict/readings.hpp"
#include "ripplenotch/verdict/side_column.hpp"

namespace ripplenotch {

namespace {

// All lines of one log; whatever is wrong with it is a line, too.

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

/// A request whose words were understood, for all its logs.
struct FeatureWork {
    CommonOptions common;
    ReadOptions read;
    std::optional<GearAccount> gear;
    std::optional<NamePattern> pattern;
    std::optional<double> temperature_degc;         ///< stated for all logs
    std::optional<std::string> temperature_column;  ///< with {joint} in the place of a joint's name
    bool date_from_file = false;
};

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
        line.date_source = "the log's clock has no day; --date-from-name or --date-from-file supplies it";
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
        line.temperature_source = "not stated; --temperature names a column or a number";
    }
}

FeatureLine line_of(const Log& log, const ManifestEntry& entry, const FeatureWork& work, FeatureLine line) {
    refuse_open_readings(log);  // torque over a speed in deg/s or rad/s is no number to be kept
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

// One line a joint of the log, in the log's order. Errors of the log are lines with an error; only what is
// no matter of one log is thrown.
std::vector<FeatureLine> feature_lines(const ManifestEntry& entry, const FeatureWork& work) {
    FeatureLine head;
    head.log = entry.log;
    head.version = version();
    head.robot = entry.robot.value_or("");
    std::vector<FeatureLine> lines;
    try {
        std::vector<Log> logs = read_joints_in_part(entry.log, work.read, most_rows_looked_at);
        if (entry.log != "-") head.sha256 = sha256_as_read(entry.log);
        for (const Log& log : logs) {
            FeatureLine line = head;
            line.joint = log.trace.joint;
            for (const LogWarning& warning : log.recording.warnings) say(work.common, warning.text);
            try {
                lines.push_back(line_of(log, entry, work, line));
            } catch (const Error& error) {
                lines.push_back(failed_line(line, error));
            }
        }
        if (logs.empty()) raise<DataError>("{}: no joint has a motion and a torque", entry.log);
    } catch (const Error& error) {
        lines.push_back(failed_line(head, error));
    }
    return lines;
}

namespace fs = std::filesystem;

std::string sha256_of(std::string_view bytes) {
    Sha256 hash;
    hash.update(bytes);
    return hash.hex();
}

std::vector<std::string> record_names(const std::string& folder) {
    std::error_code failed;
    std::vector<std::string> names;
    for (fs::directory_iterator at(folder, failed), end; !failed && at != end; at.increment(failed))
        if (at->path().filename().string().ends_with(record_ending)) names.push_back(at->path().string());
    if (failed) raise<FileError>("{}: {}", folder, failed.message());
    std::sort(names.begin(), names.end());
    return names;
}

// A record of the same shard that is there already, if its lines are as it says. One that is of another job
// is somebody else's work, and is not written over.
bool is_complete(const std::string& name, const ShardRecord& wanted, bool force) {
    if (!fs::exists(name)) return false;
    const ShardRecord found = shard_record_from_json(read_all(name), name);
    const std::string why = why_mixed(found, wanted);
    if (!why.empty() && force) return false;
    if (!why.empty())
        raise<DataError>("{} is of another job: {}; take another folder, or --force", name, why);
    try {
        static_cast<void>(lines_of_record(found, name));
        return true;
    } catch (const Error&) {
        return false;  // it is done again
    }
}

std::string without_option(std::string line, std::string_view option) {
    for (std::size_t at = 0; (at = line.find(option, at)) != std::string::npos;) {
        const std::size_t behind = at + option.size();
        const bool whole = at > 0 && line[at - 1] == ' ' && behind < line.size() &&
                           (line[behind] == ' ' || line[behind] == '=');
        if (!whole) {
            at = behind;
            continue;
        }
        // The value ends at the first blank outside of quotes.
        std::size_t end = behind + 1;
        for (bool quoted = false; end < line.size() && (quoted || line[end] != ' '); ++end)
            if (line[end] == '\'') quoted = !quoted;
        line.erase(at - 1, end - at + 1);
    }
    return line;
}

// A command line without list and shard: what two shards of one job have in common.
// Neither where the work comes from nor how its lines may be called changes them.
std::string shard_settings(const std::string& command_line) {
    std::string settings = without_option(without_option(command_line, "--manifest"), "--shard") + " ";
    for (const std::string_view same : {" --json ", " --ndjson "})
        if (const std::size_t at = settings.find(same); at != std::string::npos)
            settings.erase(at, same.size() - 1);
    settings.pop_back();
    return settings;
}

}  // namespace

std::string lines_of_record(const ShardRecord& record, const std::string& record_name) {
    const std::string name =
        record_name.substr(0, record_name.size() - record_ending.size()) + std::string(".ndjson");
    std::string lines = read_all(name);
    if (sha256_of(lines) != record.sha256)
        raise<DataError>("{}: its bytes differ from those that {} lists; do shard {}/{} again", name,
                         record_name, record.shard.number, record.shard.of);
    return lines;
}

ShardFolder read_shard_folders(const std::vector<std::string>& folders) {
    ShardFolder found;
    for (const std::string& folder : folders)
        for (const std::string& name : record_names(folder)) {
            found.records.push_back(shard_record_from_json(read_all(name), name));
            found.names.push_back(name);
        }
    return found;
}

namespace {

struct FeatureRequest {
    CommonOptions common;
    ReadOptions log;
    GearOptions gear;
    std::vector<std::string> logs;
    std::optional<std::string> manifest, shard, missing;
    int shards = 0;
    std::optional<std::string> date_from_name, temperature;
    bool date_from_file = false, ndjson = false, csv = false;
};

// Does the shard, unless it is complete. Throws DataError where the folder holds another job.
void do_shard(const FeatureRequest& request, const FeatureWork& work, const Manifest& manifest,
              const std::string& settings) {
    ShardRecord record{
        std::string(version()), manifest.sha256, settings, shard_of(*request.shard), 0, 0, 0, {}};
    std::error_code failed;
    fs::create_directories(request.common.output, failed);
    if (failed) raise<FileError>("{}: {}", request.common.output, failed.message());
    const std::string folder = request.common.output + "/";
    const std::string record_name = folder + record_file_name(record.shard);
    if (is_complete(record_name, record, request.common.force)) {
        say(request.common, fmt::format("shard {} is complete already", *request.shard));
        return;
    }
    std::string text;
    const OneCore engine_has_the_others;
    for (const ManifestEntry& entry : part_of(manifest, record.shard)) {
        ++record.logs;
        for (const FeatureLine& line : feature_lines(entry, work)) {
            ++record.lines;
            if (line.failed()) {
                ++record.failed;
                warn(request.common, line.error);
            }
            text += feature_line_text(line);
        }
    }
    record.sha256 = sha256_of(text);
    // The lines first: a record is there only where its lines are.
    const ByteSink::Overwrite over{true, !request.common.no_sync};
    write_all(folder + shard_file_name(record.shard), text, over);
    write_all(record_name, shard_record_text(record), over);
}

// Throws UsageError.
FeatureWork work_of(const FeatureRequest& request) {
    FeatureWork work;
    work.common = request.common;
    work.gear = GearChoice(request.gear).of();
    if (!work.gear && !request.gear.orders.empty()) raise_no_gear("--orders");
    work.read = read_options(request.log, work.gear);
    work.read.takes_motor_units = true;
    if (request.date_from_name) work.pattern.emplace(*request.date_from_name);
    work.date_from_file = request.date_from_file;
    if (request.temperature) {
        work.temperature_degc = parse_number(*request.temperature);
        if (!work.temperature_degc) work.temperature_column = *request.temperature;
        const double degc = work.temperature_degc.value_or(0.0);
        if (!(degc > -274.0 && degc < 1000.0))
            raise<UsageError>("--temperature {} is no temperature in degrees Celsius", shortest(degc));
    }
    return work;
}

void check_features(const FeatureRequest& request) {
    if (request.csv && (request.ndjson || request.common.json))
        raise<UsageError>("--csv and {}: one of them", request.ndjson ? "--ndjson" : "--json");
    if (request.shard && !request.manifest)
        raise<UsageError>("--shard needs the list that it is cut from: --manifest");
    if (request.shard && request.common.output == "-")
        raise<UsageError>("--shard writes into a folder: -o DIR");
    if (request.shard && request.csv)
        raise<UsageError>("--shard writes lines of JSON; merge puts them together");
    if (request.manifest && !request.logs.empty())
        raise<UsageError>("--manifest lists the logs; '{}' is one more", request.logs.front());
    if ((request.missing.has_value()) != (request.shards > 0))
        raise<UsageError>("--missing DIR and --shards n go together");
    if (request.missing && (request.shard || request.manifest || !request.logs.empty()))
        raise<UsageError>("--missing asks about a folder, and reads no logs");
    if (!request.missing && !request.manifest && request.logs.empty())
        raise<UsageError>("LOG is missing: name logs, or a list of them by --manifest");
    if (!request.shard && !request.missing)
        check_output_name(request.common.output, "lines of features", ".ndjson .jsonl .csv .txt");
}

ExitCode print_missing(const FeatureRequest& request) {
    const ShardFolder found = read_shard_folders({*request.missing});
    std::string text;
    for (const std::size_t number :
         missing_shards(found.records, found.names, static_cast<std::size_t>(request.shards)))
        text += fmt::format("{}\n", number);
    write_text("-", text, ByteSink::Overwrite::no);
    return ExitCode::done;
}

ExitCode print_lines(const FeatureRequest& request, const FeatureWork& work,
                     std::span<const ManifestEntry> entries) {
    std::vector<FeatureLine> all;
    std::string text;
    std::size_t failed = 0;
    Progress::current().begin("reading", "logs", entries.size() > 1 ? entries.size() : 0);
    for (const ManifestEntry& entry : entries) {
        for (FeatureLine& line : feature_lines(entry, work)) {
            if (line.failed()) {
                ++failed;
                warn(request.common, line.error);
            }
            if (request.csv)
                all.push_back(std::move(line));
            else
                text += feature_line_text(line);
        }
        if (entries.size() > 1) Progress::current().add(1);
    }
    if (request.csv) text = features_csv(all);
    write_all(request.common.output, text, request.common.overwrite());
    if (failed > 0 && (entries.size() > 1 || failed > 1))
        warn(request.common, fmt::format("{} of the lines have an error instead of descriptors", failed));
    return failed > 0 ? ExitCode::data : ExitCode::done;
}

ExitCode run_features(FeatureRequest& request, const std::string& command_line) {
    check_features(request);
    if (request.missing) return print_missing(request);
    const FeatureWork work = work_of(request);
    Manifest manifest;
    if (request.manifest) {
        manifest = manifest_of(read_all(*request.manifest),
                               *request.manifest == "-" ? "standard input" : *request.manifest);
    } else {
        for (const std::string& log : request.logs) manifest.entries.push_back({log, {}, {}, {}});
    }
    if (!request.shard) return print_lines(request, work, manifest.entries);
    do_shard(request, work, manifest, shard_settings(command_line));
    return ExitCode::done;
}

void attach_output(Options& options, FeatureRequest& request) {
    options.text("-o,--output", request.common.output, "FILE",
                 "where the lines go; - is standard output; with --shard the folder of the shards");
    options.writes("-o");
    options.flag("--ndjson", request.ndjson, "one JSON object a line; so it is unless --csv is given");
    options.flag("--json", request.common.json, "the same: a log of one joint is one JSON object");
    options.flag("--csv", request.csv, "a table with a header instead");
    attach_manner(options, request.common);
}

std::function<ExitCode()> attach_features(Options& options) {
    const auto request = std::make_shared<FeatureRequest>();
    options.arguments("LOG", request->logs, false, "logs, in any number");
    attach_gear(options, request->gear);
    options.text("--manifest", request->manifest, "FILE",
                 "a list of logs, a line each, with date=, robot=, temperature_degc= after tabs");
    options.text("--shard", request->shard, "I/N",
                 "do only part I of N of the list, into the folder of -o, once");
    options.text("--missing", request->missing, "DIR",
                 "print the numbers of the shards that DIR lacks, and end");
    options.count("--shards", request->shards, 0, static_cast<int>(most_shards),
                  "with --missing: of how many");
    options.text("--date-from-name", request->date_from_name, "PATTERN",
                 "date and robot from a log's name: %Y %m %d %H %M %S, {robot}, *, ?");
    options.flag("--date-from-file", request->date_from_file,
                 "where neither name nor clock states the day, use that of the file's last change");
    options.text("--temperature", request->temperature, "COLUMN",
                 "the joint's temperature: a column in degrees Celsius, {joint} in it for a joint's name, or "
                 "a number");
    attach_log(options, request->log);
    attach_output(options, *request);
    return [request, &options] { return run_features(*request, options.command_line()); };
}

}  // namespace

const Command commands::features{
    .name = "features",
    .summary = "descriptors of each joint of a log in one line: ratio, ripple, friction, lost motion",
    .description =
        "A line for each log and joint with its descriptors and their intervals, for one log or for a fleet "
        "in shards.\nWhat a log does not determine is null, with the reason. A log that cannot be read is a "
        "line with its error; exit code 3\nreports that there was one.\nExample: ripplenotch features "
        "logs/*.csv --gear-ratio 100 --date-from-name '*_%Y-%m-%d.csv' -o all.ndjson",
    .attach = attach_features,
};

namespace {

// What features was asked for.

}  // namespace

}  // namespace ripplenotch
