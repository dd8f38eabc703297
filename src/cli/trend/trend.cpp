// SPDX-License-Identifier: MIT
// ripplenotch trend: which joint of a fleet changed, when, by how much, and what in it.

#include <fmt/format.h>

#include <iterator>
#include <memory>
#include <string>

#include "cli/command.hpp"
#include "cli/talk.hpp"
#include "ripplenotch/chart/figures.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/progress.hpp"
#include "ripplenotch/document/results.hpp"
#include "ripplenotch/fleet/trend.hpp"

namespace ripplenotch {

namespace {

// What changed, for people: the alerts, and what could not be looked at.

constexpr std::size_t max_notes = 20;

std::string size_of(const ChangedDescriptor& one) {
    const double half = 0.5 * (one.ci95.high - one.ci95.low);
    std::string text = fmt::format("{} {:+.3g} +/- {:.2g}", one.name, one.size, half);
    if (one.percent) text += fmt::format(" ({:+.1f} %)", *one.percent);
    return text;
}

TextRows alerts_of(const Trend& trend) {
    TextRows rows = {{"joint", "since", "surest sign, 95 %", "also", "p"}};
    for (const JointTrend& joint : trend.joints) {
        for (const JointChange& change : joint.changes) {
            std::string others;
            for (std::size_t i = 1; i < change.descriptors.size(); ++i)
                others += (i > 1 ? ", " : "") + change.descriptors[i].name;
            rows.push_back({joint.name(), change.drift ? "all the time" : change.date.substr(0, 10),
                            change.descriptors.empty() ? "" : size_of(change.descriptors.front()), others,
                            fmt::format("{:.1g}", change.p)});
        }
    }
    return rows;
}

std::string notes_of(const Trend& trend) {
    std::vector<std::string> notes = trend.notes;
    for (const JointTrend& joint : trend.joints)
        for (const std::string& note : joint.notes)
            notes.push_back((joint.name().empty() ? "the joint" : joint.name()) + ": " + note);
    std::string text;
    for (std::size_t i = 0; i < notes.size() && i < max_notes; ++i) text += "\n" + notes[i];
    if (notes.size() > max_notes)
        text += fmt::format("\nand {} more notes in --json", notes.size() - max_notes);
    return text.empty() ? text : text + "\n";
}

std::string trend_report(const Trend& trend) {
    std::string text = trend_verdict(trend) + "\n";
    const TextRows alerts = alerts_of(trend);
    if (alerts.size() > 1) text += "\n" + text_table(alerts, "llllr");
    return text + notes_of(trend);
}

struct TrendRequest {
    CommonOptions common;
    std::vector<std::string> files;
    int seed = 1;
};

std::vector<FeatureLine> read_lines(const TrendRequest& request, Provenance& provenance) {
    std::vector<FeatureLine> lines;
    for (const std::string& path : request.files) {
        std::vector<FeatureLine> own = feature_lines_from_text(read_all(path), input_name(path));
        provenance.inputs.push_back({path, path == "-" ? "" : sha256_as_read(path), own.size()});
        std::move(own.begin(), own.end(), std::back_inserter(lines));
    }
    return lines;
}

Answer run_trend(const TrendRequest& request, const std::string& command_line) {
    Provenance provenance{{}, command_line};
    const std::vector<FeatureLine> lines = read_lines(request, provenance);
    if (!lines.empty() && lines.front().version != version())
        warn(request.common, fmt::format("the lines are by version {} of the tool, and this is {}",
                                         lines.front().version, version()));
    const auto trend =
        std::make_shared<const Trend>(trend_of(lines, static_cast<std::uint64_t>(request.seed)));
    return {.text = trend_report(*trend),
            .document = [trend, provenance] { return trend_text(*trend, provenance); },
            .figure = [trend] { return trend_figure(*trend); },
            .provenance = provenance};
}

std::function<Answer()> attach_trend(Options& options) {
    const auto request = std::make_shared<TrendRequest>();
    options.arguments("FEATURES", request->files, true,
                      "lines of features, of any number of logs; - is standard input");
    options.count("--seed", request->seed, 0, 2147483647, "of the orders that chance is counted by");
    attach_plot(options, request->common);
    attach_common(options, request->common, {"a trend", ".txt .json"});
    return [request, &options] { return run_trend(*request, options.command_line()); };
}

}  // namespace

const Command commands::trend{
    .name = "trend",
    .summary = "which joint of a fleet changed, when, by how much, and what in it",
    .description =
        "Reads lines of features and looks at each joint for steps and drifts of its descriptors, after what "
        "temperature,\n"
        "load and speed explain. One alert in 1000 months of a joint is chance.\n"
        "Example: ripplenotch trend fleet.ndjson -o trend.json --plot trend.svg",
    .attach = attach_trend,
};

}  // namespace ripplenotch
