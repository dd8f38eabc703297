// SPDX-License-Identifier: MIT
// ripplenotch trend: which joint of a fleet changed, when, by how much, and what in it.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "cli/command.hpp"
#include "cli/options/plot_request.hpp"
#include "cli/talk.hpp"
#include "ripplenotch/chart/trend_figure.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/progress.hpp"
#include "ripplenotch/document/features_json.hpp"
#include "ripplenotch/document/trend_json.hpp"
#include "ripplenotch/fleet/trend.hpp"

namespace ripplenotch {

namespace {

// Where the reports of single logs are, so that a trend can lead to them.

namespace fs = std::filesystem;

constexpr std::array telling = {"{log}", "{stem}", "{name}", "{date}"};  // a page of each log

// What may stand in an address as it is; a name may hold anything else.
std::string as_address(const std::string& name) {
    std::string address;
    for (const char c : name) {
        const auto byte = static_cast<unsigned char>(c);
        const bool plain = byte < 128 && (std::isalnum(byte) != 0 ||
                                          std::string_view("/._-~").find(c) != std::string_view::npos);
        address += plain ? std::string(1, c) : fmt::format("%{:02X}", byte);
    }
    return address;
}

std::string filled(std::string pattern, const JointTrend& joint, const std::string& log,
                   const std::string& date) {
    const fs::path path(log);
    const std::array<std::pair<std::string, std::string>, 6> values = {
        {{"{log}", log},
         {"{stem}", fs::path(path).replace_extension().string()},
         {"{name}", path.stem().string()},
         {"{robot}", joint.robot},
         {"{joint}", joint.joint},
         {"{date}", date.substr(0, 10)}}};
    std::string address;
    for (std::size_t at = 0; at < pattern.size();) {
        const auto* found = std::find_if(values.begin(), values.end(), [&](const auto& value) {
            return pattern.compare(at, value.first.size(), value.first) == 0;
        });
        address += found == values.end() ? std::string(1, pattern[at]) : as_address(found->second);
        at += found == values.end() ? 1 : found->first.size();
    }
    return address;
}

std::string page_beside(const std::string& log) {
    std::error_code failed;
    for (const fs::path& page : {fs::path(log).replace_extension(".html"), fs::path(log + ".html")})
        if (page != fs::path(log) && fs::is_regular_file(page, failed)) return as_address(page.string());
    return {};
}

// Throws UsageError for a pattern of pages that names no log: {log}, {stem} (without its ending), {name}
// (without folders and ending), {robot}, {joint}, {date}.
void check_page_pattern(const std::optional<std::string>& pattern) {
    if (!pattern) return;
    for (const char* word : telling)
        if (pattern->find(word) != std::string::npos) return;
    raise<UsageError>("--log-page '{}' is the same for all logs; one of {} distinguishes them", *pattern,
                      "{log}, {stem}, {name}, {date}");
}

// The address of each log's report that an alert or a course names: by the pattern, else STEM.html or
// LOG.html beside the log, where there is one.
void add_log_pages(Trend& trend, const std::optional<std::string>& pattern) {
    std::map<std::string, std::string> known;  // a look at the disk a log
    for (JointTrend& joint : trend.joints) {
        const auto page_of = [&](const std::string& log, const std::string& date) {
            if (pattern) return filled(*pattern, joint, log, date);
            const auto [at, is_new] = known.try_emplace(log);
            if (is_new) at->second = page_beside(log);
            return at->second;
        };
        for (JointChange& change : joint.changes) {
            change.first_page = page_of(change.first_log, change.first_date);
            change.last_page = page_of(change.last_log, change.last_date);
            for (AdjustedValue& value : change.course) value.page = page_of(value.log, value.date);
        }
    }
}

// What changed, for people: the alerts, joints unlike their kind, and what could not be looked at.

constexpr std::size_t most_odd = 20, most_notes = 20;
using TrendRows = std::vector<std::vector<std::string>>;

std::string day_of(const std::string& date) { return date.substr(0, 10); }

std::string days_of(const JointChange& change) {
    if (change.drift) return "all the time";
    if (change.earliest == change.latest) return day_of(change.date);
    return fmt::format("{} ({} to {})", day_of(change.date), day_of(change.earliest), day_of(change.latest));
}

std::string size_of(const ChangedDescriptor& one) {
    const double half = 0.5 * (one.ci95.high - one.ci95.low);
    std::string text = fmt::format("{} {:+.3g} +/- {:.2g}", one.name, one.size, half);
    if (one.percent) text += fmt::format(" ({:+.1f} %)", *one.percent);
    return text;
}

TrendRows alerts_of(const Trend& trend) {
    TrendRows rows = {{"joint", "alert", "since", "surest sign, 95 %", "p", ""}};
    for (const JointTrend& joint : trend.joints) {
        for (const JointChange& change : joint.changes) {
            rows.push_back({joint.name(), (change.drift ? "drift: " : "") + change.cause, days_of(change),
                            change.descriptors.empty() ? "" : size_of(change.descriptors.front()),
                            fmt::format("{:.1g}", change.p),
                            change.kin == 0 ? "" : fmt::format("so did {} of its kind", change.kin)});
        }
    }
    return rows;
}

TrendRows odd_of(const Trend& trend) {
    TrendRows rows = {{"joint", "descriptor", "baseline", "its kind", "deviations"}};
    for (const JointTrend& joint : trend.joints)
        for (const OddDescriptor& one : joint.odd)
            if (rows.size() <= most_odd)
                rows.push_back({joint.name(), one.name, fmt::format("{:.4g}", one.baseline),
                                fmt::format("{:.4g}", one.of_kind), fmt::format("{:+.1f}", one.deviations)});
    return rows;
}

std::string notes_of(const Trend& trend) {
    std::vector<std::string> notes = trend.notes;
    for (const JointTrend& joint : trend.joints)
        for (const std::string& note : joint.notes)
            notes.push_back((joint.name().empty() ? "the joint" : joint.name()) + ": " + note);
    std::string text;
    for (std::size_t i = 0; i < notes.size() && i < most_notes; ++i) text += "\n" + notes[i];
    if (notes.size() > most_notes)
        text += fmt::format("\nand {} more notes in --json", notes.size() - most_notes);
    return text.empty() ? text : text + "\n";
}

std::string trend_report(const Trend& trend) {
    std::string text = trend_verdict(trend) + "\n";
    const TrendRows alerts = alerts_of(trend), odd = odd_of(trend);
    if (alerts.size() > 1) text += "\n" + text_table(alerts, "llllrl");
    if (odd.size() > 1) text += "\nunlike the others of their kind\n" + text_table(odd, "llrrr");
    return text + notes_of(trend);
}

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
    Provenance provenance{{}, command_line};
    const std::vector<FeatureLine> lines = read_lines(request, provenance);
    if (!lines.empty() && lines.front().version != version())
        warn(request.common, fmt::format("the lines are by version {} of the tool, and this is {}",
                                         lines.front().version, version()));
    Trend trend = trend_of(lines, {rate, static_cast<std::uint64_t>(request.seed)});
    add_log_pages(trend, request.log_page);
    const bool lines_alone = request.ndjson && !ends_with_json(request.common.output);
    write_result(
        request.common, [&] { return trend_text(trend, provenance); },
        lines_alone ? alert_lines(trend) : trend_report(trend));
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
    options.text("--log-page", request->log_page, "PATTERN",
                 "where a log's own report is: '{stem}.html', 'pages/{robot}/{date}.html'; default: in the "
                 "log's folder");
    attach_plot(options, request->plot, request->common);
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
