// SPDX-License-Identifier: MIT
// ripplenotch spectrum: amplitude of the torque against frequency or against output order.

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <memory>

#include "cli/command.hpp"
#include "cli/gear/joint_facts.hpp"
#include "cli/given/residual.hpp"
#include "cli/options/plot_request.hpp"
#include "cli/readings/readings.hpp"
#include "cli/spectrum/spectrum_text.hpp"
#include "cli/spectrum/speed_map_request.hpp"
#include "cli/spectrum/streamed_spectrum.hpp"
#include "cli/talk.hpp"
#include "ripplenotch/chart/spectrum_figure.hpp"
#include "ripplenotch/core/memory.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/output_name.hpp"
#include "ripplenotch/document/spectrum_json.hpp"
#include "ripplenotch/log/log.hpp"

namespace ripplenotch {
namespace {

constexpr std::array<std::string_view, 2> domain_names = {"frequency", "order"};

struct SpectrumRequest {
    CommonOptions common;
    LogOptions log;
    std::string path, domain = "frequency";
    std::optional<std::string> stretch;
    std::optional<Seconds> segment;
    double false_alarm = 0.01;
    SteadyRule steady;
    SpeedMapRequest map;
    ResidualOptions residual;
    PlotRequest plot;
    bool peaks = false;

    /// Frequencies of all of the log are the same however the joint moves.
    [[nodiscard]] bool needs_motion() const {
        return stretch || map.map || residual.any() || domain != "frequency";
    }
    /// Half-overlapping pieces of all of the log, which need no more of it at a time.
    [[nodiscard]] bool in_pieces() const { return segment && !needs_motion(); }
};

/// The parts of the log that are asked for: all of it, every steady stretch, or one of them by number.
std::vector<std::pair<std::optional<int>, Stretch>> parts_of(const SpectrumRequest& request,
                                                             const TraceView& trace) {
    if (!request.stretch) return {{std::nullopt, whole_log(trace)}};
    const std::vector<Stretch> found = steady_stretches(trace, request.steady);
    std::vector<std::pair<std::optional<int>, Stretch>> parts;
    for (std::size_t i = 0; i < found.size(); ++i) parts.emplace_back(static_cast<int>(i) + 1, found[i]);
    if (parts.empty()) {
        raise<DataError>(
            "{}: no steady stretch of {} s or longer; lower --steady-for, widen --steady-band, or leave out "
            "--stretch",
            request.path, shortest(request.steady.at_least.value()));
    }
    if (*request.stretch == "all") return parts;
    const auto number = parse_number(*request.stretch);
    if (!number || *number < 1.0 || *number != std::floor(*number)) {
        raise<UsageError>("--stretch: '{}' is neither all nor a number from 1 on", *request.stretch);
    }
    if (*number > static_cast<double>(parts.size())) {
        raise<UsageError>("--stretch {}: {} has {} steady stretch{}", *request.stretch, request.path,
                          parts.size(), parts.size() == 1 ? "" : "es");
    }
    return {parts[static_cast<std::size_t>(*number) - 1]};
}

/// What goes to the output, and the figure of it.
struct Result {
    std::string text;
    std::function<Figure()> figure;
};

Result order_result(const SpectrumRequest& request, const TraceView& trace, const std::string& joint,
                    const std::string& doubt, const Provenance& provenance) {
    if (request.stretch || request.segment)
        raise<UsageError>("--stretch and --segment belong to --domain frequency");
    MotionLinesOptions options;
    options.false_alarm = request.false_alarm;
    OrderSpectrum result{
        stack_sweeps(cut_sweeps({&trace, 1}, options.sweeps).pieces, Axis::angle, options.stack),
        find_motion_lines({&trace, 1}, options), doubt};
    if (result.lines.sweeps == 0) {
        raise<DataError>(
            "{}: the joint nowhere moves {} output turns in one direction, so there is no order spectrum",
            request.path, shortest(options.sweeps.shortest_turns));
    }
    std::string text = request.common.json
                           ? order_spectrum_text(joint, result, request.false_alarm, provenance)
                       : request.peaks ? order_peaks(result)
                                       : order_csv(result.stack);
    return {std::move(text), [result, source = joint_in_words(request.path, joint)] {
                return order_spectrum_figure(source, result.stack, result.lines);
            }};
}

Figure frequency_figure(const std::string& source, const std::vector<StretchSpectrum>& spectra) {
    std::vector<ShownSpectrum> shown;
    for (const StretchSpectrum& one : spectra) {
        const std::string name =
            one.number ? fmt::format("Stretch {}, {:.4g} deg/s", *one.number, one.stretch.speed.value()) : "";
        shown.push_back({name, &one.spectrum, one.stretch.smears_orders()});
    }
    return spectrum_figure(source, shown);
}

std::vector<StretchSpectrum> frequency_spectra(const SpectrumRequest& request, const TraceView& trace) {
    std::vector<StretchSpectrum> spectra;
    for (const auto& [number, stretch] : parts_of(request, trace)) {
        spectra.push_back({number, stretch,
                           torque_spectrum(trace.part(stretch.first, stretch.count),
                                           {request.segment, request.false_alarm})});
    }
    return spectra;
}

// A piece that is longer than what there is is all of it.
void say_segment(const SpectrumRequest& request, const StretchSpectrum& one) {
    constexpr double rounding = 1.01;  // of the piece's length to whole samples
    const double piece_s = one.spectrum.piece_duration.value();
    if (!request.segment || request.segment->value() <= rounding * piece_s) return;
    const std::string what = one.number ? fmt::format("stretch {}", *one.number) : "the log";
    say_warnings(request.common,
                 std::vector{fmt::format("--segment {} s: {} is {:.4g} s long, so all of it is one piece",
                                         shortest(request.segment->value()), what, piece_s)});
}

Result frequency_result(const SpectrumRequest& request, std::vector<StretchSpectrum> spectra,
                        const std::string& joint, const Provenance& provenance) {
    for (const StretchSpectrum& one : spectra) say_segment(request, one);
    if (!request.common.json && !request.peaks && request.common.verbose && !request.common.quiet)
        talk_lines(frequency_peaks(spectra));
    std::string text = request.common.json ? spectra_text(joint, spectra, request.false_alarm, provenance)
                       : request.peaks     ? frequency_peaks(spectra)
                                           : frequency_csv(spectra);
    return {std::move(text), [spectra = std::move(spectra), source = joint_in_words(request.path, joint)] {
                return frequency_figure(source, spectra);
            }};
}

Result map_result(const SpectrumRequest& request, const MapLines& lines, const Trace& trace,
                  const Provenance& provenance) {
    SpeedMapResult result = speed_map_result(request.map, lines, trace, request.common, provenance);
    return {std::move(result.text),
            [map = std::move(result.map), lines, source = joint_in_words(request.path, trace.joint)] {
                return speed_map_figure(source, map, lines);
            }};
}

using Made = std::pair<Result, Provenance>;

/// The log goes by and is not held.
Made piecewise_result(const SpectrumRequest& request, const std::string& command_line) {
    ReadOptions reading = request.log.resolve();
    reading.needs_velocity = false;
    LogPasses log(request.path, reading);
    const StretchSpectrum spectrum = streamed_spectrum(log, {request.segment, request.false_alarm}, [&] {
        say_layout(request.common, log.layout());
        say_warnings(request.common, log.recording().warnings);
    });
    const Provenance provenance{{input_record(request.path)}, command_line, {{log.recording()}}};
    return {frequency_result(request, {spectrum}, log.layout().chosen.joint, provenance), provenance};
}

// Of a log that is held with all that is made of it; measured.
constexpr double bytes_a_row_by_frequency = 144.0, bytes_a_row_by_order = 88.0;

void require_memory_for_spectrum(const SpectrumRequest& request, const ReadOptions& read) {
    const auto rows = estimated_rows(request.path, read);
    const auto left = memory_to_be_had();
    if (!rows || !left) return;
    const bool by_order = request.domain == "order" || request.map.map;
    const double bytes = *rows * (by_order ? bytes_a_row_by_order : bytes_a_row_by_frequency);
    if (bytes <= static_cast<double>(*left)) return;
    constexpr double mebibyte = 1024.0 * 1024.0;
    raise<MemoryError>(
        "{}: a spectrum of the whole log takes about {:.3g} MiB for some {:.3g} rows, and {:.3g} MiB are to "
        "be "
        "had; take it in pieces with --segment, or a part of the log with --from and --to",
        request.path, bytes / mebibyte, *rows, static_cast<double>(*left) / mebibyte);
}

Made whole_result(const SpectrumRequest& request, const std::string& command_line) {
    Provenance provenance{{}, command_line};
    const MapLines lines = request.map.map ? map_lines(request.map, provenance) : MapLines{};
    if (lines.gear) say(request.common, gear_in_words(*lines.gear));
    LogOptions words = request.log;
    take_joint_of(request.residual, words.joint);
    ReadOptions reading = read_options(words, lines.gear);
    reading.needs_velocity = request.needs_motion();
    require_memory_for_spectrum(request, reading);
    Log log = read_log(request.path, reading);
    say_layout(request.common, log.layout);
    take_residual(request.residual, reading, 1, {request.path, log}, request.common, provenance);
    say_warnings(request.common, log.recording.warnings);
    provenance.inputs.insert(provenance.inputs.begin(), input_record(request.path));
    provenance.recordings.push_back({log.recording});
    const bool by_order = request.domain == "order" || request.map.map == "order";
    const std::string doubt =
        by_order ? reading_doubt({&log, 1}, [](const OtherReading&) { return true; }) : "";
    if (!doubt.empty()) say_warnings(request.common, std::vector{doubt});
    if (request.map.map) return {map_result(request, lines, log.trace, provenance), provenance};
    const TraceView trace = log.trace.view();
    if (request.domain == "order")
        return {order_result(request, trace, log.trace.joint, doubt, provenance), provenance};
    return {frequency_result(request, frequency_spectra(request, trace), log.trace.joint, provenance),
            provenance};
}

ExitCode run_spectrum(SpectrumRequest& request, const std::string& command_line) {
    if (!(request.false_alarm > 0.0) || request.false_alarm > 0.5) {
        raise<UsageError>("--false-alarm {} is not between 0 and 0.5", shortest(request.false_alarm));
    }
    if (request.segment && !(request.segment->value() > 0.0))
        raise<UsageError>("--segment must be above 0 s");
    if (!(request.steady.at_least.value() > 0.0)) raise<UsageError>("--steady-for must be above 0 s");
    check_speed_map(request.map);
    check_plot(request.plot, request.common);
    hash_where_told(request.common, request.plot);
    if (request.map.map &&
        (request.stretch || request.segment || request.peaks || request.domain != "frequency"))
        raise<UsageError>("--map goes with neither --domain, --stretch, --segment nor --peaks");
    if (request.peaks) check_output_name(request.common.output, "a table of lines", ".txt .json");
    const auto [result, provenance] =
        request.in_pieces() ? piecewise_result(request, command_line) : whole_result(request, command_line);
    if (request.peaks || !request.plot.instead_of(request.common.output))
        write_text(request.common.output, result.text, request.common.overwrite());
    draw_plot(request.plot, request.common, provenance, result.figure);
    return ExitCode::done;
}

std::function<ExitCode()> attach_spectrum(Options& options) {
    const auto request = std::make_shared<SpectrumRequest>();
    options.argument("LOG", request->path, true, "a log; - is standard input");
    options.choice("--domain", request->domain, domain_names,
                   "against frequency, or against cycles per output turn");
    options.text("--stretch", request->stretch, "all|NUMBER",
                 "steady stretches instead of the whole log, each or one of them");
    options.quantity("--segment", request->segment, Dimension::time,
                     "average half-overlapping pieces of this length (Welch)");
    options.flag("--peaks", request->peaks, "tables of the lines and humps instead of the bins");
    options.number("--false-alarm", request->false_alarm, Dimension::none,
                   "chance that noise gives any line in a spectrum");
    options.number("--steady-band", request->steady.band_percent, Dimension::none,
                   "a stretch is steady while its speed stays within this many per cent ...");
    options.number("--steady-band-speed", request->steady.band_deg_s, Dimension::speed,
                   "... or within this speed, whichever is wider; none by default");
    options.quantity("--steady-for", request->steady.at_least, Dimension::time, "for at least this long");
    attach_speed_map(options, request->map);
    attach_residual(options, request->residual);
    attach_plot(options, request->plot);
    attach_log(options, request->log);
    attach_common(options, request->common, {"a spectrum", ".csv .txt .json", true});
    return [request, &options] { return run_spectrum(*request, options.command_line()); };
}

}  // namespace

const Command commands::spectrum{
    .name = "spectrum",
    .summary = "amplitude of the torque against frequency or output order",
    .description =
        "Writes CSV (frequency_hz, amplitude_nm, psd_nm2_hz, floor_nm), with --json or --peaks the lines "
        "that stand out of the\n"
        "noise. Amplitudes are zero to peak in Nm, whatever the window and the length.\n"
        "Example: ripplenotch spectrum log.csv --peaks",
    .attach = attach_spectrum,
};

}  // namespace ripplenotch
