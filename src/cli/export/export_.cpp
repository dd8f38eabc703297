// SPDX-License-Identifier: MIT
// `export`: tables and filters to firmware and tools, read back and run there. The trailing underscore is
// C++'s: export is a keyword.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <string>

#include "cli/command.hpp"
#include "cli/export/target_choice.hpp"
#include "cli/options/options.hpp"
#include "cli/talk.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/core/progress.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/document/model_json.hpp"
#include "ripplenotch/document/results.hpp"
#include "ripplenotch/document/simulation_json.hpp"
#include "ripplenotch/document/table_json.hpp"
#include "ripplenotch/evaluate/contender.hpp"
#include "ripplenotch/export/joint_target.hpp"
#include "ripplenotch/export/target.hpp"
#include "ripplenotch/filter/engine.hpp"
#include "ripplenotch/filter/map_fit.hpp"
#include "ripplenotch/verdict/gear_choice.hpp"

namespace ripplenotch {

namespace {

struct ExportRequest {
    std::string table, to;
    std::optional<std::string> method;
    GearOptions gear;
    std::optional<Hertz> sample_rate;
    int band = 0;
    std::optional<std::string> motor_of;  ///< of a map: another joint than its own
    std::optional<double> tolerance_percent;
    CommonOptions common;
};

// What every export does with the file that it made: writes it, reads it again, reports what came through.

void write_export(const Written& written, const CommonOptions& common, bool binary = false) {
    ByteSink sink(common.output, common.overwrite(), binary);
    sink.write(written.bytes);
    sink.finish();
    say_warnings(common, written.warnings);
}

// What was written, as it stands in the file; that of a pipe or a device, which cannot be read again, as it
// was in memory.
struct ReadBack {
    std::string bytes, source;  // source: "notch.h", "standard output"
};

ReadBack read_back(const Written& written, const CommonOptions& common) {
    const bool file = std::filesystem::is_regular_file(common.output);
    return {file ? read_all(common.output) : written.bytes,
            common.output == "-" ? "standard output" : common.output};
}

// What was found out about it: on standard output, unless the file itself went there.
Answer shown(const std::string& text, const CommonOptions& common) {
    const bool is_free = common.output != "-";
    if (!is_free && common.verbose) talk_lines(text);
    return {.text = is_free ? text : "", .own_output = true};
}

// Where a generated file is from, and whose it is.
std::vector<std::string> generated_by(const Provenance& provenance) {
    std::vector<std::string> lines = heading_of(provenance);
    lines.emplace_back("This file is yours to use, change and pass on, without conditions.");
    return lines;
}

// `export` of a method whose coefficients change while it runs.

constexpr std::size_t samples = 1'000'000, block = 10'000;
constexpr double swing_s = 5.0, fastest_deg_s = 80.0 * 2.0 * std::numbers::pi / swing_s;

// A joint that swings under a slow torque, with ripple of every order and noise: the same on every machine.
// With a map it swings where the map was made, no faster than there.
class Swing {
  public:
    Swing(const Contender& method, Hertz sample_rate) : gear_(*method.gear), rate_hz_(sample_rate.value()) {
        if (method.map == nullptr) return;
        const RippleMap& map = *method.map;
        if (map.speeds_deg_s.to > 0.0) fastest_deg_s_ = std::min(fastest_deg_s_, map.speeds_deg_s.to);
        position_ = map.positions_deg.middle();
    }

    struct Sample {
        double torque_nm, velocity_deg_s, position_deg;
    };
    Sample at(std::size_t k) {
        const double phase = 2.0 * std::numbers::pi * static_cast<double>(k) / rate_hz_ / swing_s;
        const double velocity = fastest_deg_s_ * portable::cos(phase);
        // By trapezoids, as the tool adds a velocity up: while the motor is slow it may take that way.
        if (k > 0) position_ += 0.5 * (before_ + velocity) / rate_hz_;
        before_ = velocity;
        const double turns = gear_.ratio.value() * position_ / 360.0;
        double torque = 6.0 * portable::sin(0.3 * phase) + 0.05 * noise();
        for (const Order order : gear_.orders)
            torque += 0.5 * portable::cos(2.0 * std::numbers::pi * order.value() * turns + order.value());
        return {torque, velocity, position_};
    }

  private:
    // Sum of four even numbers from -1 to 1, about the variance of a normal one.
    double noise() {
        double sum = 0.0;
        for (int i = 0; i < 4; ++i) {
            state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
            sum += static_cast<double>(state_ >> 40U) / static_cast<double>(1U << 23U) - 1.0;
        }
        return sum;
    }

    const GearAccount& gear_;
    double rate_hz_, fastest_deg_s_ = fastest_deg_s;
    double position_ = 0.0, before_ = 0.0;
    std::uint64_t state_ = 20;
};

struct CodeCheck {
    double largest_error_nm = 0.0, largest_nm = 0.0;
};

CodeCheck run_beside(const Contender& method, Hertz sample_rate, const RunningDesign& design,
                     const LoadedCode& code) {
    CodeCheck check;
    const auto* const oscillator = std::get_if<OscillatorDesign>(&design);
    const double ratio = oscillator != nullptr ? oscillator->gear_ratio : 0.0;
    const bool within_turn = oscillator != nullptr && repeats_each_turn(oscillator->orders);
    Swing swing(method, sample_rate);
    const auto filter = method.start(sample_rate);
    std::vector<double> torque(block), velocity(block), position(block), out(block), coded(block);
    for (std::size_t first = 0; first < samples; first += block) {
        for (std::size_t k = 0; k < block; ++k) {
            const Swing::Sample now = swing.at(first + k);
            torque[k] = now.torque_nm;
            velocity[k] = now.velocity_deg_s;
            position[k] = now.position_deg;
            double turns = ratio * now.position_deg / 360.0;
            if (within_turn) turns -= std::floor(turns);
            coded[k] = code.step({now.torque_nm, now.velocity_deg_s, turns, now.position_deg});
        }
        filter->process({velocity, torque, position}, out);
        for (std::size_t k = 0; k < block; ++k) {
            check.largest_error_nm = std::max(check.largest_error_nm, std::abs(coded[k] - out[k]));
            check.largest_nm = std::max(check.largest_nm, std::abs(out[k]));
        }
    }
    return check;
}

// Of what runs on other numbers than coefficients: a share of what it comes to.
Answer within_tolerance(Answer answer, double error_nm, double whole_nm, std::string_view whole,
                        const std::optional<double>& tolerance_percent) {
    const double percent = 100.0 * error_nm / whole_nm;
    if (!tolerance_percent || percent <= *tolerance_percent) return answer;
    answer.complaints.push_back(
        fmt::format("ripplenotch export: largest error {:.2g} % of the {}, tolerance {} %", percent, whole,
                    shortest(*tolerance_percent)));
    answer.code = ExitCode::limit_violated;
    return answer;
}

// Writes its code, reads it back and runs it beside the method itself over a million samples.
// Throws UsageError for a target that takes coefficients only.
Answer export_code(const ExportRequest& request, const Contender& method, const std::string& command_line) {
    if (request.common.json) raise<UsageError>("--json: export of a method as code has no JSON result yet");
    const Spec spec = parse_spec(request.to);
    if (!is_code_target(spec.name)) {
        raise<UsageError>("target {} takes coefficients, and those of {} change while it runs; use c-header",
                          spec.name, method.method->name);
    }
    const Settings settings = settings_of(spec, method_code_keys());
    check_output_name(request.common.output, spec.name, ".h .hpp");
    const RunningDesign design = method.method->running(method.settings, *request.sample_rate);
    const Written written = write_method_code(design, settings, generated_by({{}, command_line}));
    write_export(written, request.common);
    const ReadBack again = read_back(written, request.common);
    const LoadedCode code = read_method_code(again.bytes, again.source, design, settings);
    const CodeCheck check = run_beside(method, *request.sample_rate, design, code);
    return within_tolerance(
        shown(fmt::format(
                  "{}: {}, read back and compared with the method over {} samples in {}.\nlargest output     "
                  "     {:.4g} Nm\nlargest difference      {:.1e} Nm\n",
                  again.source, spec.text(), samples, code.arithmetic, check.largest_nm,
                  check.largest_error_nm),
              request.common),
        check.largest_error_nm, check.largest_nm, "largest output", request.tolerance_percent);
}

// `export` of a ripple map.

// That of the joint's own motor, or of the motor of another joint: a map each, since each goes by an angle of
// its own.
RippleMap map_of_motor(const ExportRequest& request) {
    const RippleMap all = load_map(request.table).map;
    const std::string names = joined(all.others, ", ", [](const RippleMap& map) { return map.joint; });
    if (request.motor_of) {
        for (const RippleMap& other : all.others)
            if (other.joint == *request.motor_of) return other;
        raise<DataError>("{}: it holds no ripple of the motor of {}, but of {}", request.table,
                         *request.motor_of, names.empty() ? "its own joint alone" : names);
    }
    if (!names.empty())
        warn(request.common,
             fmt::format(
                 "{}: the ripple of the {} of {} in this torque is not exported with it; --motor-of exports "
                 "it by itself, to be taken from this torque at the position and speed of that joint",
                 request.table, all.others.size() == 1 ? "motor" : "motors", names));
    return all;
}

// Writes the map in the form of the target, reads it back and tells what came through. Throws UsageError,
// DataError.
Answer export_map(const ExportRequest& request, const std::string& command_line) {
    if (request.common.json) raise<UsageError>("--json: export of a map has no JSON result yet");
    const Spec spec = parse_spec(request.to);
    const MapTarget& target = find_map_target(spec.name);
    check_output_name(request.common.output, target.name, target.endings);
    const Settings settings = settings_of(spec, target.keys);
    const RippleMap map = map_of_motor(request);
    if (map.orders.empty())
        raise<DataError>("{}: the map is empty: there is nothing to export", request.table);
    const Written written =
        target.write(map, settings, generated_by({{input_record(request.table)}, command_line}));
    write_export(written, request.common);
    const ReadBack again = read_back(written, request.common);
    const LoadedMap loaded = target.read(again.bytes, again.source, map, settings);
    const MapCheck check = verify_map_export(map, loaded);
    return within_tolerance(
        shown(fmt::format(
                  "{}: {}, read back and run at {} states in {}.\nripple of the map       {:.4g} Nm rms\n"
                  "not representable       {:.4g} Nm rms\nlargest error           {:.2g} Nm\n",
                  again.source, target.name, check.states, loaded.arithmetic, check.ripple_nm,
                  check.not_held_nm, check.largest_error_nm),
              request.common),
        check.largest_error_nm, check.ripple_nm, "map's ripple, rms", request.tolerance_percent);
}

// `export` of the model of a joint, to what simulates it.

// A function and arguments are not run here: the report lists what they hold, and why they do not hold the
// rest.
Answer export_model(const ExportRequest& request, const std::string& command_line) {
    if (request.common.json) raise<UsageError>("--json: export of a model has no JSON result yet");
    const Spec spec = parse_spec(request.to);
    const JointTarget& target = find_joint_target(spec.name);
    check_output_name(request.common.output, target.name, target.endings);
    const Settings settings = settings_of(spec, target.keys);
    const ModelWithGiven model = read_model_with_given(read_all(request.table), request.table);
    if (model.any_given())
        raise<DataError>(
            "{}: an arm or a simulation is part of the model, which the target has not; export "
            "a model of the effects alone",
            request.table);
    if (const auto missing = missing_values(model.model); !missing.empty())
        raise<DataError>(
            "{}: the model does not state {}; diagnose --improved-model writes a model that does",
            request.table, missing.front());
    const WrittenJoint written =
        target.write(model.model, settings, generated_by({{input_record(request.table)}, command_line}));
    write_export({written.text, {}}, request.common);
    std::string text = fmt::format("{}: {}\n", request.common.output, target.summary);
    for (const MjcfPart& part : written.holds) text += fmt::format("held: {}: {}\n", part.effect, part.words);
    for (const MjcfPart& part : written.not_held)
        text += fmt::format("not held: {}: {}\n", part.effect, part.words);
    if (model.ripple) text += "not held: ripple_map: export it from map.json\n";
    return shown(text, request.common);
}

// What was read back, for people.

std::string depth_text(const SectionCheck& check) {
    if (!check.is_notch) return "-";
    const double depth = check.depth_db.value_or(check.response_depth_db);
    return depth >= deepest_measured_db ? fmt::format(">{:.0f}", deepest_measured_db) : rounded(depth, 1);
}

std::vector<std::string> row(const SectionCheck& check, bool bands) {
    std::vector<std::string> cells;
    if (bands) cells.push_back(std::to_string(check.band));
    cells.push_back(check.order ? order_text(*check.order, check.gear_ratio) : std::to_string(check.section));
    cells.push_back(fmt::format("{:.6g}", check.center.value()));
    cells.push_back(check.shift_percent ? rounded(*check.shift_percent, 4) : "none");
    cells.push_back(fmt::format("{:.4g}", check.q));
    cells.push_back(depth_text(check));
    cells.push_back(cell_text(check.dc_error_db, 5));
    cells.push_back(cell_text(check.mean_error_nm, 4, 1e3));
    cells.push_back(rounded(check.pole_radius, 7));
    return cells;
}

std::string export_report_to_text(const ExportReport& report) {
    const bool bands = !report.checks.empty() && report.checks.front().band > 0;
    std::string text = fmt::format("{}: {}, read back and run at {} Hz in {}.\n\n",
                                   report.file == "-" ? "standard output" : report.file, report.target,
                                   shortest(report.sample_rate.value()), report.arithmetic);
    const bool orders = !report.checks.empty() && report.checks.front().order.has_value();
    TextRows rows = {{orders ? "order" : "section", "centre Hz", "shift %", "Q", "depth dB", "DC error dB",
                      "mean error mNm", "pole radius"}};
    if (bands) rows.front().insert(rows.front().begin(), "band");
    for (const SectionCheck& check : report.checks) rows.push_back(row(check, bands));
    text += text_table(rows, "r");
    text += fmt::format("\nThe torque it ran on: {} Nm, and 1 Nm of ripple at the designed centre.\n",
                        shortest(verify_load_nm));
    return text;
}

constexpr std::size_t max_violations_said = 5;

/// Methods that an export can hold: coefficients, a table of them, or code.
bool can_export(const Method& method) {
    return method.steady != nullptr || method.needs_table || method.running != nullptr;
}
std::string exported_methods() {
    std::vector<const Method*> all;
    for (const Method* method : methods())
        if (can_export(*method)) all.push_back(method);
    return name_list(std::span<const Method* const>(all));
}

/// As `filter` would run it: a table alone is method switching with its defaults.
bool switches(const ExportRequest& request) {
    return !request.method || find_method(parse_spec(*request.method).name).needs_table;
}

void check_export(const ExportRequest& request) {
    if (request.to.empty()) raise<UsageError>("--to is missing; targets: {}", name_list(export_targets()));
    if (request.table.empty() == !request.method) {
        raise<UsageError>("{}", request.method
                                    ? "a table and --method: give one of them"
                                    : "nothing to export; name a table.json, or give --method, for example "
                                      "--method fixed,centers=25Hz:50Hz --sample-rate 1kHz");
    }
    if (request.method) {
        const Method& method = find_method(parse_spec(*request.method).name);
        if (!can_export(method))
            raise<UsageError>(
                "method {} is no set of coefficients and has no code; export takes a table.json, {}",
                method.name, exported_methods());
    }
    if (!switches(request) && !request.sample_rate)
        raise<UsageError>(
            "--method needs --sample-rate, the rate at which the filter will run, for example 1kHz");
    if (switches(request) && request.sample_rate)
        raise<UsageError>("a table has its own sample rate; --sample-rate goes with other methods");
    if (request.common.json && request.common.output == "-")
        raise<UsageError>(
            "the exported file and --json would both go to standard output; name a file with -o");
    if (request.tolerance_percent && !(*request.tolerance_percent >= 0.0))
        raise<UsageError>("--tolerance {} is below 0", shortest(*request.tolerance_percent));
}

Contender method_of(const ExportRequest& request) {
    const GearChoice gear(request.gear);
    if (request.method) return choose_method(*request.method, std::nullopt, gear);
    return choose_method("switching", request.table, gear);
}

// What a target without code of its own leaves to whoever switches its filters.
std::optional<std::string> left_to_caller(const Target& target, const FilterSet& filters) {
    const SwitchingDesign& design = filters.switching;
    if (target.runs_supervisor || !filters.by_speed()) return std::nullopt;
    if (design.hysteresis.value() == 0.0 && design.dwell_samples == 0) return std::nullopt;
    return fmt::format(
        "target {} holds the filters alone: hysteresis={}deg/s and dwell={} samples are left to the code "
        "that switches them",
        target.name, shortest(design.hysteresis.value()), design.dwell_samples);
}

void add_violations(const ExportReport& report, Answer& answer) {
    if (report.violations.empty()) return;
    answer.code = ExitCode::limit_violated;
    for (std::size_t i = 0; i < std::min(report.violations.size(), max_violations_said); ++i)
        answer.complaints.push_back(fmt::format("ripplenotch export: {}", report.violations[i]));
    if (report.violations.size() > max_violations_said)
        answer.complaints.push_back(fmt::format("ripplenotch export: and {} more past a limit",
                                                report.violations.size() - max_violations_said));
}

Answer run_export(const ExportRequest& request, const std::string& command_line) {
    check_export(request);
    if (is_document(request.table, "map")) return export_map(request, command_line);
    if (is_document(request.table, "model")) return export_model(request, command_line);
    if (request.motor_of) raise<UsageError>("--motor-of is for maps, and {} is none", request.table);
    const Spec spec = parse_spec(request.to);
    const Target& target = find_target(spec.name);
    const Contender method = method_of(request);
    if (method.method->running != nullptr) return export_code(request, method, command_line);
    if (ends_with_json(request.common.output) && target.name != "json")
        raise<UsageError>("-o {}: {} is no JSON; use --to json, or name the file otherwise",
                          request.common.output, target.name);
    check_output_name(request.common.output, target.name, target.endings);
    const Settings settings = settings_of(spec, target.keys);
    Provenance provenance{{}, command_line};
    FilterSet filters = filters_of(method, request.sample_rate);
    for (const std::string& file : method.files) provenance.inputs.push_back(input_record(file));
    if (request.band != 0) filters = only_band(filters, request.band);

    Written written = target.write(filters, settings, generated_by(provenance));
    if (auto left = left_to_caller(target, filters)) written.warnings.push_back(std::move(*left));
    write_export(written, request.common, target.binary);

    ExportReport report{spec.text(),
                        request.common.output,
                        written.bytes.size(),
                        filters.sample_rate,
                        filters.bands.size(),
                        filters.sections_per_band(),
                        written.warnings,
                        {},
                        {},
                        {},
                        {}};
    if (target.usage != nullptr)
        report.usage =
            target.usage(filters, settings, request.common.output == "-" ? "FILE" : request.common.output);
    if (!report.usage.empty()) say(request.common, report.usage);
    const ReadBack again = read_back(written, request.common);
    const LoadedFilters loaded = target.read(again.bytes, again.source, filters, settings);
    report.checks = verify_export(filters, loaded, again.source);
    report.arithmetic = arithmetic_name(loaded.bands.front().front().arithmetic);
    report.violations = export_violations(report.checks, request.tolerance_percent);

    Answer answer = shown(export_report_to_text(report), request.common);
    add_violations(report, answer);
    answer.document = [report = std::move(report), provenance] {
        return export_report_to_json(report, provenance);
    };
    return answer;
}

std::function<Answer()> attach_export(Options& options) {
    auto request = std::make_shared<ExportRequest>();
    options.argument("TABLE", request->table, false,
                     "table.json from design, map.json from map, or model.json; - is standard input");
    options.text("--to,--target", request->to, "TARGET[,KEY=VALUE...]",
                 fmt::format("{}; of a map {}; of a model {}; see docs/export", name_list(export_targets()),
                             name_list(map_targets()), name_list(joint_targets())));
    options.text("--method", request->method, "SPEC",
                 fmt::format("instead of a table: {} with its keys, as filter has them, for example "
                             "switching,table=table.json,hysteresis=1deg/s",
                             exported_methods()));
    attach_gear(options, request->gear);
    options.text("--motor-of", request->motor_of, "JOINT",
                 "of a map: the ripple of this other joint's motor, which goes by the position and speed of "
                 "that joint");
    options.number("--sample-rate", request->sample_rate, Dimension::frequency,
                   "with --method: rate at which the filter will run");
    options.count("--band", request->band, 0, 1000000,
                  "only this band of the table, to run at every speed; 0 is the whole table");
    options.number("--tolerance", request->tolerance_percent, Dimension::none,
                   "per cent, e.g. 0.1: exit code 1 when a centre has moved by more, or the gain error there "
                   "or at 0 Hz is larger; of code and maps, when their largest error is more of the largest "
                   "output or of the ripple");
    attach_common(options, request->common, {});
    return [request, &options] { return run_export(*request, options.command_line()); };
}

}  // namespace

const Command commands::export_ = {
    .name = "export",
    .summary = "tables and filters to firmware and tools, re-read and re-measured",
    .description =
        "Writes a table of design, or one filter, in the form that a target takes: a C header, CMSIS-DSP, "
        "SciPy, MATLAB,\nROS, servo drives, JSON. The written file is read again, run in the target's "
        "arithmetic, and measured.\nripplenotch export table.json --to c-header -o notch.h --tolerance 0.1",
    .attach = attach_export,
};

}  // namespace ripplenotch
