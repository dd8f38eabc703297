// SPDX-License-Identifier: MIT
// ripplenotch features: what one log tells of each of its joints, in one line, for one log or a million.

#include <fmt/format.h>

#include <memory>

#include "cli/command.hpp"
#include "cli/features/feature_lines.hpp"
#include "cli/features/shard_work.hpp"
#include "cli/talk.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/output_name.hpp"
#include "ripplenotch/core/progress.hpp"
#include "ripplenotch/document/features_json.hpp"

namespace ripplenotch {

FeatureWork work_of(const FeatureRequest& request) {
    FeatureWork work;
    work.common = request.common;
    work.gear = GearChoice(request.gear).of();
    if (!work.gear && !request.gear.orders.empty()) raise_no_gear("--orders");
    work.read = read_options(request.log, work.gear);
    work.read.takes_motor_units = true;
    if (!work.read.joint) work.read.joint = "all";
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

namespace {

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
                say_warnings(request.common, std::vector{line.error});
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
        say_warnings(
            request.common,
            std::vector{fmt::format("{} of the lines have an error in the place of descriptors", failed)});
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
    options.writes(&request.common.output);
    options.flag("--ndjson", request.ndjson, "one JSON object a line; so it is unless --csv is given");
    options.flag("--json", request.common.json, "the same: a log of one joint is one JSON object");
    options.flag("--csv", request.csv, "a table with a header instead");
    options.flag("--force", request.common.force, "overwrite existing files");
    options.flag("--no-sync", request.common.no_sync, "do not wait until written files are on the disk");
    options.flag("-q,--quiet", request.common.quiet, "no warnings on standard error");
    options.flag("-v,--verbose", request.common.verbose, "say on standard error what was decided");
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
                 "where neither name nor clock tell the day, take that of the file's last change");
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
    .summary = "what a log tells of each joint in one line: ratio, ripple, friction, lost motion",
    .description =
        "A line for each log and joint with its descriptors and their intervals, for one log or for a fleet "
        "in "
        "shards.\n"
        "What a log does not tell is null, with the reason. A log that cannot be read is a line with its "
        "error; "
        "exit code 3\n"
        "tells that there was one.\n"
        "Example: ripplenotch features logs/*.csv --gear-ratio 100 --date-from-name '*_%Y-%m-%d.csv' -o "
        "all.ndjson",
    .attach = attach_features,
};

}  // namespace ripplenotch
