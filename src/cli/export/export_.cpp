// SPDX-License-Identifier: MIT
// `export`: tables and filters to firmware and tools, read back and run there. The trailing underscore is
// C++'s: export is a keyword.

#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <optional>

#include "cli/command.hpp"
#include "cli/export/export_code.hpp"
#include "cli/export/export_map.hpp"
#include "cli/export/export_text.hpp"
#include "cli/export/written_file.hpp"
#include "cli/gear/chosen_method.hpp"
#include "cli/gear/joint_facts.hpp"
#include "cli/options/name_list.hpp"
#include "cli/talk.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/output_name.hpp"
#include "ripplenotch/core/version.hpp"
#include "ripplenotch/document/export_json.hpp"
#include "ripplenotch/document/map_json.hpp"
#include "ripplenotch/document/table_json.hpp"
#include "ripplenotch/export/map_target.hpp"
#include "ripplenotch/export/method_code.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t most_violations_said = 5;

struct ExportRequest {
    std::string table, to;
    std::optional<std::string> method;
    std::optional<Hertz> sample_rate;
    int band = 0;
    bool verify = false;
    ExportLimits limits;
    CommonOptions common;
};

/// "fixed or lowpass": the methods that are coefficients, each as `words` has its name.
std::string steady_methods(const char* words) {
    std::string joined;
    for (const Method* method : methods()) {
        if (method->steady == nullptr) continue;
        joined += (joined.empty() ? "" : " or ") + fmt::format(fmt::runtime(words), method->name);
    }
    return joined;
}

void check_export(const ExportRequest& request) {
    if (request.to.empty()) raise<UsageError>("--to is missing; targets: {}", name_list(export_targets()));
    if (request.table.empty() == !request.method) {
        raise<UsageError>("{}", request.method
                                    ? "a table and --method: give one of them"
                                    : "nothing to export; name a table.json, or give --method, for example "
                                      "--method fixed,centers=25Hz:50Hz --sample-rate 1kHz");
    }
    if (request.method && !request.sample_rate)
        raise<UsageError>(
            "--method needs --sample-rate, the rate at which the filter will run, for example 1kHz");
    if (!request.method && request.sample_rate)
        raise<UsageError>("a table has its own sample rate; --sample-rate goes with --method");
    if (request.common.json && request.common.output == "-")
        raise<UsageError>(
            "the exported file and --json would both go to standard output; name a file with -o");
    for (const auto& [name, value] : {std::pair{"--max-centre-shift-percent", request.limits.shift_percent},
                                      std::pair{"--min-depth-db", request.limits.depth_db},
                                      std::pair{"--max-dc-error-db", request.limits.dc_error_db},
                                      std::pair{"--max-pole-radius", request.limits.pole_radius}}) {
        if (value && !(*value >= 0.0)) raise<UsageError>("{} {} is below 0", name, shortest(*value));
    }
    if (request.limits.depth_db && *request.limits.depth_db > deepest_measured_db) {
        raise<UsageError>("--min-depth-db {}: no more than {} dB is measured",
                          shortest(*request.limits.depth_db), shortest(deepest_measured_db));
    }
}

FilterSet filters_of_method(const ExportRequest& request) {
    const Method& method = find_method(parse_spec(*request.method).name);
    if (method.steady == nullptr) {
        raise<UsageError>("method {} is no set of coefficients; export takes a table.json, {}", method.name,
                          steady_methods("--method {},..."));
    }
    const Contender chosen = choose_method(*request.method);
    return std::visit([&](const auto& design) { return filter_set(design, *request.sample_rate); },
                      method.steady(chosen.settings));
}

std::vector<std::string> heading_of(const Provenance& provenance) {
    std::vector<std::string> lines = {fmt::format("Made by {} {}:", tool_name, version()),
                                      provenance.command};
    for (const InputRecord& input : provenance.inputs) {
        lines.push_back(input.sha256.empty() ? fmt::format("from {}", input.name)
                                             : fmt::format("from {}, SHA-256 {}", input.name, input.sha256));
    }
    return lines;
}

void verify(const ExportRequest& request, const Target& target, const Settings& settings,
            const FilterSet& filters, const Written& written, ExportReport& report) {
    const ReadBack again = read_back(written, request.common);
    const LoadedFilters loaded = target.read(again.bytes, again.source, filters, settings);
    report.checks = verify_export(filters, loaded, again.source);
    report.arithmetic = arithmetic_name(loaded.bands.front().front().arithmetic);
    report.verified = true;
    report.violations = export_violations(report.checks, request.limits);
}

void say_violations(const ExportReport& report) {
    for (std::size_t i = 0; i < std::min(report.violations.size(), most_violations_said); ++i) {
        talk(fmt::format("ripplenotch export: {}", report.violations[i]));
    }
    if (report.violations.size() > most_violations_said) {
        talk(fmt::format("ripplenotch export: and {} more past a limit",
                         report.violations.size() - most_violations_said));
    }
}

ExitCode run_export(const ExportRequest& request, const std::string& command_line) {
    check_export(request);
    if (is_map(request.table))
        return export_map({request.table, request.to, request.verify, request.common}, command_line);
    if (request.method && has_code(parse_spec(*request.method).name)) {
        if (request.limits.any())
            raise<UsageError>("limits are on coefficients, and those of this method change");
        const Contender method = choose_method(*request.method);
        return export_code({method, *request.sample_rate, request.to, request.verify, request.common},
                           command_line);
    }
    const Spec spec = parse_spec(request.to);
    const Target& target = find_target(spec.name);
    if (ends_with_json(request.common.output) && target.name != "json")
        raise<UsageError>("-o {}: {} is no JSON; use --to json, or name the file otherwise",
                          request.common.output, target.name);
    check_output_name(request.common.output, target.name, target.endings);
    const Settings settings(fmt::format("target {}", spec.name), spec, target.keys);
    Provenance provenance{{}, command_line};
    FilterSet filters = request.method ? filters_of_method(request) : filter_set(load_table(request.table));
    if (!request.method) provenance.inputs.push_back(input_record(request.table));
    if (request.band != 0) filters = only_band(filters, request.band);

    const Written written = target.write(filters, settings, heading_of(provenance));
    write_export(written, request.common, target.binary);

    ExportReport report{spec.text(),
                        request.common.output,
                        written.bytes.size(),
                        filters.sample_rate,
                        filters.bands.size(),
                        filters.sections_per_band(),
                        written.warnings,
                        {},
                        false,
                        {},
                        {},
                        {}};
    if (target.usage != nullptr)
        report.usage =
            target.usage(filters, settings, request.common.output == "-" ? "FILE" : request.common.output);
    if (!report.usage.empty()) say(request.common, report.usage);
    if (request.verify || request.limits.any()) verify(request, target, settings, filters, written, report);

    if (request.common.json) {
        write_text("-", export_report_to_json(report, provenance), ByteSink::Overwrite::no);
    } else if (report.verified) {
        tell_check(export_report_to_text(report), request.common);
    }
    say_violations(report);
    return report.violations.empty() ? ExitCode::done : ExitCode::limit_violated;
}

std::function<ExitCode()> attach_export(Options& options) {
    auto request = std::make_shared<ExportRequest>();
    options.argument("TABLE", request->table, false,
                     "table.json from design, or map.json from map; - is standard input");
    options.text("--to", request->to, "TARGET[,KEY=VALUE...]",
                 fmt::format("{}; of a map {}; see docs/export", name_list(export_targets()),
                             name_list(map_targets())));
    options.text("--method", request->method, "SPEC",
                 fmt::format("instead of a table: {} with its keys, for example fixed,centers=25Hz:50Hz,q=1",
                             steady_methods("{}")));
    options.quantity("--sample-rate", request->sample_rate, Dimension::frequency,
                     "with --method: rate at which the filter will run");
    options.count("--band", request->band, 0, 1000000,
                  "only this band of the table, to run at every speed; 0 is the whole table");
    options.flag("--verify", request->verify,
                 "read the file again, run it in the target's arithmetic, and print what came through");
    options.number("--max-centre-shift-percent", request->limits.shift_percent, Dimension::none,
                   "exit code 1 when a centre has moved by more");
    options.number("--min-depth-db", request->limits.depth_db, Dimension::decibel,
                   "exit code 1 when a notch is less deep at its designed centre");
    options.number("--max-dc-error-db", request->limits.dc_error_db, Dimension::decibel,
                   "exit code 1 when the gain at 0 Hz is off by more");
    options.number("--max-pole-radius", request->limits.pole_radius, Dimension::none,
                   "exit code 1 when a pole is further out; 1 and beyond is always refused");
    attach_common(options, request->common, {});
    return [request, &options] { return run_export(*request, options.command_line()); };
}

}  // namespace

const Command commands::export_ = {
    .name = "export",
    .summary = "tables and filters to firmware and tools, re-read and re-measured",
    .description =
        "Writes a table of design, or one filter, in the form that a target takes: a C header, CMSIS-DSP, "
        "SciPy, "
        "MATLAB,\nROS, servo drives, Betaflight- and ArduPilot-style parameters, JSON. With --verify the "
        "written "
        "file is read again,\nrun in the target's arithmetic, and measured.\n"
        "ripplenotch export table.json --to c-header -o notch.h --verify --min-depth-db 60",
    .attach = attach_export,
};

}  // namespace ripplenotch
