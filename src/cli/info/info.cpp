// SPDX-License-Identifier: MIT
// ripplenotch info: what is in a log, and what can be done with it.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>

#include "cli/command.hpp"
#include "cli/info/info_text.hpp"
#include "cli/options/plot_request.hpp"
#include "cli/talk.hpp"
#include "ripplenotch/core/inputs_read.hpp"
#include "ripplenotch/document/info_json.hpp"
#include "ripplenotch/log/format.hpp"

namespace ripplenotch {
namespace {

struct InfoRequest {
    CommonOptions common;
    LogOptions log;
    std::vector<std::string> paths;
};

ExitCode run_info(const InfoRequest& request, const std::string& command_line) {
    const ReadOptions options = request.log.resolve();
    hash_where_told(request.common);
    std::vector<LogInfo> logs;
    Provenance provenance{{}, command_line};
    for (const std::string& path : request.paths) {
        logs.push_back(survey_log(path, options));
        const LogInfo& log = logs.back();
        provenance.inputs.push_back({path, path == "-" ? "" : sha256_as_read(path), log.rows});
        say(request.common, log.source + ": read as if with " + log.layout.options);
    }
    std::string text;
    if (request.common.json) {
        text = info_to_json(logs, provenance);
    } else {
        for (const LogInfo& log : logs) text += (text.empty() ? "" : "\n") + info_to_text(log);
        if (const auto missing = formats_not_built(); !missing.empty())
            text += fmt::format("\nnot in this build: {}\n", fmt::join(missing, ", "));
    }
    write_text(request.common.output, text, request.common.overwrite());
    return ExitCode::done;
}

std::function<ExitCode()> attach_info(Options& options) {
    auto request = std::make_shared<InfoRequest>();
    options.arguments("LOG", request->paths, true, "logs to look at; - is standard input");
    attach_log(options, request->log);
    attach_common(options, request->common, {"an inventory", ".txt .json", true});
    return [request, &options] { return run_info(*request, options.command_line()); };
}

}  // namespace

const Command commands::info = {
    .name = "info",
    .summary = "what is in a log and what can be done with it",
    .description =
        "Columns with their roles, units and joints; the measured sample rate, jitter, gaps, held samples; "
        "whether position\n"
        "agrees with integrated velocity; steady stretches. Example: ripplenotch info run7.csv",
    .attach = attach_info,
};

}  // namespace ripplenotch
