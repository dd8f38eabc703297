// SPDX-License-Identifier: MIT
// ripplenotch spectrum: amplitude of the torque against frequency or against output order.

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <memory>

#include "cli/command.hpp"
#include "cli/joint_facts.hpp"
#include "cli/plot_request.hpp"
#include "cli/speed_map_request.hpp"
#include "cli/text_table.hpp"
#include "ripplenotch/artifact/spectrum.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/log/log.hpp"
#include "ripplenotch/report/spectrum_figure.hpp"

namespace ripplenotch {
namespace {

constexpr std::array<std::string_view, 2> domain_names = {"frequency", "order"};

struct Request {
    CommonOptions common;
    LogOptions log;
    std::string path, domain = "frequency";
    std::optional<std::string> stretch;
    std::optional<Seconds> segment;
    double false_alarm = 0.01;
    SteadyRule steady;
    SpeedMapRequest map;
    PlotRequest plot;
    bool peaks = false;
};

/// The parts of the log that are asked for: all of it, every steady stretch, or one of them by number.
std::vector<std::pair<std::optional<int>, Stretch>> parts_of(const Request& request, const TraceView& trace) {
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

std::string frequency_csv(const std::vector<StretchSpectrum>& spectra) {
    const bool numbered = spectra.front().number.has_value();
    std::string text = numbered ? "stretch,speed_deg_s,frequency_hz,amplitude_nm,psd_nm2_hz,floor_nm\n"
                                : "frequency_hz,amplitude_nm,psd_nm2_hz,floor_nm\n";
    for (const StretchSpectrum& one : spectra) {
        for (std::size_t k = 0; k < one.spectrum.hz.size(); ++k) {
            if (numbered) {
                text += std::to_string(*one.number) + ",";
                append_shortest(text, one.stretch.speed.value());
                text += ",";
            }
            const std::array cells{one.spectrum.hz[k], one.spectrum.amplitude_nm[k],
                                   one.spectrum.psd_nm2_hz[k], one.spectrum.floor_nm[k]};
            for (std::size_t c = 0; c < cells.size(); ++c) {
                if (c > 0) text += ",";
                append_shortest(text, cells[c]);
            }
            text += "\n";
        }
    }
    return text;
}

std::string order_csv(const Stack& stack) {
    std::string text = "order_output,amplitude_nm,floor_nm,averages\n";
    for (std::size_t k = stack.first; k < stack.ratio.size(); ++k) {
        const std::array cells{static_cast<double>(k) * stack.spacing, stack.amplitude_nm[k],
                               stack.floor_nm[k], stack.averages[k]};
        for (std::size_t c = 0; c < cells.size(); ++c) {
            if (c > 0) text += ",";
            append_shortest(text, cells[c]);
        }
        text += "\n";
    }
    return text;
}

std::string frequency_peaks(const std::vector<StretchSpectrum>& spectra) {
    std::string text;
    for (const StretchSpectrum& one : spectra) {
        const Spectrum& s = one.spectrum;
        if (!text.empty()) text += "\n";
        text += one.number ? fmt::format("Stretch {}, {:.4g} deg/s: ", *one.number, one.stretch.speed.value())
                           : "";
        text += fmt::format("{} in {:.4g} s (resolution {:.3g} Hz, floor {:.2g} Nm).\n",
                            s.peaks.empty()
                                ? "no line"
                                : fmt::format("{} line{}", s.peaks.size(), s.peaks.size() == 1 ? "" : "s"),
                            one.stretch.duration.value(), s.resolution.value(), median_floor(s.floor_nm));
        if (s.peaks.empty()) continue;
        std::vector<std::vector<std::string>> rows{{"Hz", "+/-", "amplitude, Nm", "phase, deg", "SNR"}};
        for (const SpectralPeak& peak : s.peaks) {
            rows.push_back({fmt::format("{:.4f}", peak.hz), fmt::format("{:.2g}", peak.hz_stderr),
                            fmt::format("{:.4g}", peak.amplitude_nm), fmt::format("{:.1f}", peak.phase_deg),
                            fmt::format("{:.1f}", peak.snr)});
        }
        text += text_table(rows, "r");
    }
    return text;
}

std::string order_peaks(const OrderSpectrum& spectrum) {
    const MotionLines& found = spectrum.lines;
    std::string text =
        fmt::format("{} in {} over {:.3g} output turns (resolution {:.3g} orders, floor {:.2g} Nm).\n",
                    found.lines.empty()
                        ? "No line"
                        : fmt::format("{} line{}", found.lines.size(), found.lines.size() == 1 ? "" : "s"),
                    found.sweeps == 1 ? "1 sweep" : fmt::format("{} sweeps", found.sweeps), found.turns,
                    found.resolution_orders, median_floor(spectrum.stack.floor_nm));
    if (found.lines.empty()) return text;
    std::vector<std::vector<std::string>> rows{{"kind", "output order", "+/-", "Hz", "amplitude, Nm", "SNR"}};
    for (const MotionLine& line : found.lines) {
        const bool tone = line.kind == LineKind::tone, order = line.kind == LineKind::order;
        rows.push_back({std::string(line_kind_name(line.kind)),
                        tone ? "-" : fmt::format("{:.3f}", line.order_output),
                        fmt::format("{:.2g}", tone ? line.hz_stderr : line.order_stderr),
                        order ? "-" : fmt::format("{:.3f}", line.hz),
                        fmt::format("{:.4g}", line.amplitude_nm), fmt::format("{:.1f}", line.snr)});
    }
    return text + text_table(rows, "lr");
}

/// What goes to the output, and the figure of it.
struct Result {
    std::string text;
    std::function<Figure()> figure;
};

Result order_result(const Request& request, const TraceView& trace, const std::string& joint,
                    const Provenance& provenance) {
    if (request.stretch || request.segment)
        raise<UsageError>("--stretch and --segment belong to --domain frequency");
    MotionLinesOptions options;
    options.false_alarm = request.false_alarm;
    OrderSpectrum result{
        stack_sweeps(cut_sweeps({&trace, 1}, options.sweeps).pieces, Axis::angle, options.stack),
        find_motion_lines({&trace, 1}, options)};
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
        shown.push_back({name, &one.spectrum});
    }
    return spectrum_figure(source, shown);
}

Result frequency_result(const Request& request, const TraceView& trace, const std::string& joint,
                        const Provenance& provenance) {
    std::vector<StretchSpectrum> spectra;
    for (const auto& [number, stretch] : parts_of(request, trace)) {
        spectra.push_back({number, stretch,
                           torque_spectrum(trace.part(stretch.first, stretch.count),
                                           {request.segment, request.false_alarm})});
    }
    if (!request.common.json && !request.peaks && request.common.verbose)
        say(request.common, frequency_peaks(spectra));
    std::string text = request.common.json ? spectra_text(joint, spectra, request.false_alarm, provenance)
                       : request.peaks     ? frequency_peaks(spectra)
                                           : frequency_csv(spectra);
    return {std::move(text), [spectra = std::move(spectra), source = joint_in_words(request.path, joint)] {
                return frequency_figure(source, spectra);
            }};
}

Result map_result(const Request& request, const Trace& trace, const Provenance& provenance) {
    SpeedMapResult result = speed_map_result(request.map, trace, request.common, provenance);
    MapLines lines;
    if (request.map.gear_ratio) {
        lines = {GearRatio(*request.map.gear_ratio), {1.0, 2.0, 3.0, 4.0}, *request.map.map == "order"};
    }
    return {std::move(result.text),
            [map = std::move(result.map), lines, source = joint_in_words(request.path, trace.joint)] {
                return speed_map_figure(source, map, lines);
            }};
}

ExitCode run(Request& request, const std::string& command_line) {
    if (!(request.false_alarm > 0.0) || request.false_alarm > 0.5) {
        raise<UsageError>("--false-alarm {} is not between 0 and 0.5", shortest(request.false_alarm));
    }
    if (request.segment && !(request.segment->value() > 0.0))
        raise<UsageError>("--segment must be above 0 s");
    if (!(request.steady.at_least.value() > 0.0)) raise<UsageError>("--steady-for must be above 0 s");
    check_speed_map(request.map);
    check_plot(request.plot, request.common);
    if (request.map.map &&
        (request.stretch || request.segment || request.peaks || request.domain != "frequency"))
        raise<UsageError>("--map goes with neither --domain, --stretch, --segment nor --peaks");
    const Log log = read_log(request.path, request.log.resolve());
    say_layout(request.common, log.layout);
    say_warnings(request.common, log.timebase.warnings);
    const Provenance provenance{{input_record(request.path)}, command_line};
    const TraceView trace = log.trace.view();
    const Result result = request.map.map ? map_result(request, log.trace, provenance)
                          : request.domain == "order"
                              ? order_result(request, trace, log.trace.joint, provenance)
                              : frequency_result(request, trace, log.trace.joint, provenance);
    if (request.peaks || !request.plot.instead_of(request.common.output))
        write_all(request.common.output, result.text, request.common.overwrite());
    draw_plot(request.plot, request.common, provenance, result.figure);
    return ExitCode::done;
}

std::function<ExitCode()> attach(Options& options) {
    const auto request = std::make_shared<Request>();
    options.argument("LOG", request->path, true, "a log; - is standard input");
    options.choice("--domain", request->domain, domain_names,
                   "against frequency, or against cycles per output turn");
    options.text("--stretch", request->stretch, "all|NUMBER",
                 "steady stretches instead of the whole log, each or one of them");
    options.quantity("--segment", request->segment, Dimension::time,
                     "average half-overlapping pieces of this length (Welch)");
    options.flag("--peaks", request->peaks, "a table of the lines instead of the bins");
    options.number("--false-alarm", request->false_alarm, Dimension::none,
                   "chance that noise gives any line in a spectrum");
    options.number("--steady-band", request->steady.band_percent, Dimension::none,
                   "a stretch is steady while its speed stays within this many per cent ...");
    options.number("--steady-band-speed", request->steady.band_deg_s, Dimension::speed,
                   "... or within this speed, whichever is wider");
    options.quantity("--steady-for", request->steady.at_least, Dimension::time, "for at least this long");
    attach_speed_map(options, request->map);
    attach_plot(options, request->plot);
    attach_log(options, request->log);
    attach_common(options, request->common);
    return [request, &options] { return run(*request, options.command_line()); };
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
    .attach = attach,
};

}  // namespace ripplenotch
