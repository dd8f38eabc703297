// SPDX-License-Identifier: MIT
// ripplenotch trend: which joint of a fleet changed, when, by how much, and what in it.

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "cli/command.hpp"
#include "cli/options/plot_request.hpp"
#include "cli/talk.hpp"
#include "cli/trend/log_pages.hpp"
#include "cli/trend/trend_report.hpp"
#include "ripplenotch/chart/trend_figure.hpp"
#include "ripplenotch/core/inputs_read.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/version.hpp"
#include "ripplenotch/document/features_json.hpp"
#include "ripplenotch/document/trend_json.hpp"

namespace ripplenotch {
namespace {

struct TrendRequest {
    CommonOptions common;
    PlotRequest plot;
    std::vector<std::string> files;
    std::string false_alarms = "1/1000";
    int seed = 1;
    bool ndjson = false;
    std::optional<std::string> log_page;
};

// "1/1000" or "0.001"
double rate_of(const std::string& text) {
    const std::size_t slash = text.find('/');
    const auto number = parse_number(text.substr(0, slash));
    const auto of = slash == std::string::npos ? std::optional(1.0) : parse_number(text.substr(slash + 1));
    if (!number || !of || !(*of > 0.0))
        raise<UsageError>("--false-alarms '{}' is no rate such as 1/1000 or 0.001", text);
    return *number / *of;
}

std::vector<FeatureLine> read_lines(const TrendRequest& request, Provenance& provenance) {
    std::vector<FeatureLine> lines;
    for (const std::string& path : request.files) {
        const std::string source = path == "-" ? "standard input" : path;
        std::vector<FeatureLine> own = feature_lines_from_text(read_all(path), source);
        provenance.inputs.push_back({path, path == "-" ? "" : sha256_as_read(path), own.size()});
        std::move(own.begin(), own.end(), std::back_inserter(lines));
    }
    return lines;
}

ExitCode run_trend(const TrendRequest& request, const std::string& command_line) {
    const double rate = rate_of(request.false_alarms);
    if (request.ndjson && request.common.json) raise<UsageError>("--ndjson and --json: one of them");
    check_page_pattern(request.log_page);
    check_plot(request.plot, request.common);
    Provenance provenance{{}, command_line};
    const std::vector<FeatureLine> lines = read_lines(request, provenance);
    if (!lines.empty() && lines.front().version != version())
        say_warnings(request.common,
                     std::vector{fmt::format("the lines are by version {} of the tool, and this is {}",
                                             lines.front().version, version())});
    Trend trend = trend_of(lines, {rate, static_cast<std::uint64_t>(request.seed)});
    add_log_pages(trend, request.log_page);
    const std::string text = trend_report(trend);
    const bool json_file = ends_with_json(request.common.output);
    if (request.common.json || json_file) {
        write_text(request.common.output, trend_text(trend, provenance), request.common.overwrite());
        if (json_file && !request.common.json) write_text("-", text, ByteSink::Overwrite::yes);
    } else {
        write_text(request.common.output, request.ndjson ? alert_lines(trend) : text,
                   request.common.overwrite());
    }
    draw_plot(request.plot, request.common, provenance, [&] { return trend_figure(trend); });
    return ExitCode::done;
}

std::function<ExitCode()> attach_trend(Options& options) {
    const auto request = std::make_shared<TrendRequest>();
    options.arguments("FEATURES", request->files, true,
                      "lines of features, of any number of logs; - is standard input");
    options.text("--false-alarms", request->false_alarms, "RATE",
                 "alerts in a month of a joint that nothing happens to; holds for the whole report");
    options.count("--seed", request->seed, 0, 2147483647, "of the orders that chance is counted by");
    options.flag("--ndjson", request->ndjson, "an alert a line, as JSON");
    options.text(
        "--log-page", request->log_page, "PATTERN",
        "where a log's own report is: '{stem}.html', 'pages/{robot}/{date}.html'; default: beside the log");
    attach_plot(options, request->plot);
    attach_common(options, request->common, {"a trend", ".txt .json .ndjson"});
    return [request, &options] { return run_trend(*request, options.command_line()); };
}

}  // namespace

const Command commands::trend{
    .name = "trend",
    .summary = "which joint of a fleet changed, when, by how much, and what in it",
    .description =
        "Reads lines of features and looks at each joint for steps and drifts of its descriptors, after what "
        "temperature,\n"
        "load and speed explain. Names what changed by its pattern. One rate of false alarms holds for the "
        "whole "
        "report.\n"
        "Example: ripplenotch trend fleet.ndjson -o trend.json --plot trend.svg",
    .attach = attach_trend,
};

}  // namespace ripplenotch
