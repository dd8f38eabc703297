// SPDX-License-Identifier: MIT
// ripplenotch report: one self-contained HTML page from any mix of results.

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <memory>

#include "cli/command.hpp"
#include "cli/options/verdict_options.hpp"
#include "cli/report/log_report.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/page/page.hpp"

namespace ripplenotch {
namespace {

struct ReportRequest {
    ReadOptions reading;
    GearOptions gear;
    std::vector<std::string> results;
    std::string output = "-";
    bool force = false, quiet = false;
};

// Where the build and the installation put it, as seen from the program itself.
std::optional<std::string> installed_plotly() {
    std::error_code failed;
    const auto program = std::filesystem::read_symlink("/proc/self/exe", failed);
    if (failed) return std::nullopt;
    for (const auto& share :
         {program.parent_path().parent_path() / "share", program.parent_path() / "share"}) {
        const auto file = share / "ripplenotch" / "plotly-cartesian.min.js";
        if (std::filesystem::exists(file, failed)) return file.string();
    }
    return std::nullopt;
}

std::optional<std::string> plotly_js_of(const ReportRequest& request) {
    const auto path = installed_plotly();
    if (!path) {
        CommonOptions common;
        common.quiet = request.quiet;
        warn(common,
             "plotly.js is not installed (scripts/setup does it where there is npm), so the page carries "
             "pictures instead of plots");
        return std::nullopt;
    }
    std::string text = read_all(*path);
    // Such a text would end the script that it stands in.
    if (text.find("</script") != std::string::npos)
        raise<DataError>("{}: holds the end of a script; this is not plotly.js", *path);
    return text;
}

// Empty where it cannot be read: who reads all of it says why.
std::string beginning_of(const std::string& path) {
    constexpr std::size_t enough = 4096;  // bytes, for the schema of a document
    std::string text(enough, '\0');
    std::ifstream file(path, std::ios::binary);
    file.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(file.gcount()));
    return text;
}

ExitCode run_report(const ReportRequest& request, const Options& options) {
    if (ends_with_json(request.output))
        raise<UsageError>("-o {}: a report is an HTML page; name it .html", request.output);
    check_output_name(request.output, "a report", ".html .htm");
    std::vector<LogReport> logs;
    std::vector<std::string> names;
    Page page{"ripplenotch report", {}};
    for (const std::string& path : request.results) {
        // A log may be longer than the memory; what commands wrote is not.
        std::string text = path == "-" ? read_all(path) : beginning_of(path);
        if (!path.ends_with(".json") && is_log(text)) {
            logs.push_back({path, path == "-" ? std::move(text) : "",
                            options.given("--format", "--hold-bad-values"),
                            options.given("--gear-ratio", "--joint-file"),
                            options.given("--gear-ratio", "--gear-ratio"), request.quiet});
            names.push_back(shown_name(path));
            continue;
        }
        for (PageSection& section :
             sections_of_result(path == "-" ? text : read_all(path), path == "-" ? "standard input" : path))
            page.sections.push_back(std::move(section));
    }
    if (!logs.empty() && logs.size() < request.results.size())
        raise<UsageError>("a report is one of logs, or one of results; read {}",
                          fmt::join(request.results, ", "));
    if (!logs.empty()) {
        page.title = fmt::format("{}", fmt::join(names, ", "));
        page.sections = sections_of_logs(logs);
    }
    write_all(request.output, html_page(page, plotly_js_of(request)), ByteSink::Overwrite{request.force});
    return ExitCode::done;
}

std::function<ExitCode()> attach_report(Options& options) {
    const auto request = std::make_shared<ReportRequest>();
    options.arguments("RESULT", request->results, true,
                      "logs, of which info, identify, recommend and filter are run; or JSON that "
                      "commands wrote: joint.json, table.json, metrics, comparisons, diagnoses, figures "
                      "(--plot FILE.json); - is standard input");
    options.text("-o,--output", request->output, "FILE", "where the page goes; - is standard output");
    options.writes("-o");
    options.flag("--force", request->force, "overwrite existing files");
    options.flag("-q,--quiet", request->quiet, "no warnings on standard error");
    attach_gear(options, request->gear);
    attach_log(options, request->reading);
    return [request, &options] { return run_report(*request, options); };
}

}  // namespace

const Command commands::report{
    .name = "report",
    .summary = "one HTML page on a log, or from any mix of results",
    .description =
        "For a log, the page shows which ripple is in it, which filter it needs, and what that filter does. "
        "Results are put into one self-contained page: verdicts first, key numbers, plots to zoom into, "
        "tables, and the command\nthat makes each again. The page loads nothing from anywhere.\nExample: "
        "ripplenotch report log.csv -o page.html\nExample: ripplenotch report joint.json table.json "
        "torque.json -o page.html",
    .attach = attach_report,
};

}  // namespace ripplenotch
