// SPDX-License-Identifier: MIT
// ripplenotch merge: the shards of features as one file, or a refusal.

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <numeric>

#include "cli/command.hpp"
#include "cli/features/features.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

struct MergeRequest {
    CommonOptions common;
    std::vector<std::string> folders;
};

ExitCode run_merge(const MergeRequest& request) {
    const ShardFolder found = read_shard_folders(request.folders);
    if (found.records.empty())
        raise<DataError>("{}: no complete shard; 'features --manifest LIST --shard i/n -o {}' makes them",
                         request.folders.front(), request.folders.front());
    const std::size_t of = found.records.front().shard.of;
    const std::vector<std::size_t> missing = missing_shards(found.records, found.names, of);
    if (!missing.empty())
        raise<DataError>("{}: of {} shards {} missing: {}", request.folders.front(), of,
                         missing.size() == 1 ? "one is" : fmt::format("{} are", missing.size()),
                         numbers_in_words(missing));
    std::vector<std::size_t> order(of);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return found.records[a].shard.number < found.records[b].shard.number;
    });
    ByteSink sink(request.common.output, request.common.overwrite());
    std::size_t logs = 0, lines = 0, failed = 0;
    for (const std::size_t i : order) {
        sink.write(lines_of_record(found.records[i], found.names[i]));
        logs += found.records[i].logs;
        lines += found.records[i].lines;
        failed += found.records[i].failed;
    }
    sink.finish();
    say(request.common, fmt::format("{} shards, {} logs, {} lines", of, logs, lines));
    if (failed > 0)
        warn(request.common,
             fmt::format("{} of {} lines have an error instead of descriptors", failed, lines));
    return ExitCode::done;
}

std::function<ExitCode()> attach_merge(Options& options) {
    const auto request = std::make_shared<MergeRequest>();
    options.arguments("DIR", request->folders, true, "folders that 'features --shard' wrote into");
    CommonOptions& common = request->common;
    options.text("-o,--output", common.output, "FILE", "where the lines go; - is standard output");
    options.writes("-o");
    options.flag("--json", common.json, "one JSON object a line, which is what shards hold: as without it");
    options.flag("--force", common.force, "overwrite existing files");
    options.flag("--no-sync", common.no_sync, "do not wait until written files are on the disk");
    options.flag("-q,--quiet", common.quiet, "no warnings on standard error");
    options.flag("-v,--verbose", common.verbose, "print the decisions on standard error");
    return [request] { return run_merge(*request); };
}

}  // namespace

const Command commands::merge{
    .name = "merge",
    .summary = "the shards of 'features --shard' as one file, in the order of the list",
    .description =
        "Puts the lines of all shards together, in the order of the list whatever the order of the files. "
        "Refuses "
        "a\n"
        "missing shard, a shard that is there twice, shards of two jobs, and lines that changed after they "
        "were "
        "written.\n"
        "Example: ripplenotch merge shards -o fleet.ndjson",
    .attach = attach_merge,
};

}  // namespace ripplenotch
