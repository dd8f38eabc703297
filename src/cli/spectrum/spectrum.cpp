// SPDX-License-Identifier: MIT
// ripplenotch spectrum: amplitude of the torque against frequency or against output order.

#include "cli/spectrum/spectrum.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cli/command.hpp"
#include "cli/options/joint_runs.hpp"
#include "cli/options/options.hpp"
#include "cli/talk.hpp"
#include "ripplenotch/analysis/order_map.hpp"
#include "ripplenotch/analysis/spectrum.hpp"
#include "ripplenotch/analysis/sweeps.hpp"
#include "ripplenotch/chart/figures.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/document/provenance.hpp"
#include "ripplenotch/document/spectrum_json.hpp"
#include "ripplenotch/filter/engine.hpp"
#include "ripplenotch/log/log.hpp"
#include "ripplenotch/verdict/gear_choice.hpp"
#include "ripplenotch/verdict/given_terms.hpp"
#include "ripplenotch/verdict/readings.hpp"

namespace ripplenotch {

namespace {

// Spectra as people and programs read them.

std::string line_table(const std::vector<SpectralPeak>& peaks) {
    if (peaks.empty()) return "";
    TextRows rows{{"Hz", "+/-", "amplitude, Nm", "phase, deg", "SNR"}};
    for (const SpectralPeak& peak : peaks) {
        rows.push_back({fmt::format("{:.4f}", peak.hz), fmt::format("{:.2g}", peak.hz_stderr),
                        fmt::format("{:.4g}", peak.amplitude_nm), fmt::format("{:.1f}", peak.phase_deg),
                        fmt::format("{:.1f}", peak.snr)});
    }
    return text_table(rows, "r");
}

/// "a,b,c"
void append_cells(std::string& text, std::initializer_list<double> cells) {
    const char* before = "";
    for (const double cell : cells) {
        text += before;
        append_shortest(text, cell);
        before = ",";
    }
    text += "\n";
}

/// A power falls as the square of an amplitude: its small values have finer steps than the digits of the
/// largest.
double power_cell(double largest, double value) {
    constexpr int power_digits = 15;
    return to_digits(to_digits_in_row({.value = value, .largest = largest}, power_digits));
}

double largest_of(std::span<const double> values) {
    return values.empty() ? 0.0 : *std::max_element(values.begin(), values.end());
}

// The bins as CSV.
std::string frequency_csv(const Spectrum& s) {
    std::string text = "frequency_hz,amplitude_nm,psd_nm2_hz,floor_nm\n";
    const double amplitude_nm = largest_of(s.amplitude_nm), psd = largest_of(s.psd_nm2_hz);
    for (std::size_t k = 0; k < s.hz.size(); ++k) {
        append_cells(text,
                     {s.hz[k], to_digits_in_row({s.amplitude_nm[k], amplitude_nm}),
                      power_cell(psd, s.psd_nm2_hz[k]), to_digits_in_row({s.floor_nm[k], amplitude_nm})});
    }
    return text;
}

std::string order_csv(const Stack& stack) {
    std::string text = "order_output,amplitude_nm,floor_nm,averages\n";
    const double amplitude_nm = largest_of(stack.amplitude_nm);
    for (std::size_t k = stack.first; k < stack.averages.size(); ++k) {
        append_cells(text, {static_cast<double>(k) * stack.spacing,
                            to_digits_in_row({stack.amplitude_nm[k], amplitude_nm}),
                            to_digits_in_row({stack.floor_nm[k], amplitude_nm}), stack.averages[k]});
    }
    return text;
}

// The lines as tables.
std::string frequency_peaks(const LogSpectrum& one) {
    const Spectrum& s = one.spectrum;
    std::string text =
        fmt::format("{} in {:.4g} s (resolution {:.3g} Hz, floor {:.2g} Nm).\n",
                    s.peaks.empty() ? "no line" : how_many(s.peaks.size(), "line"),
                    one.stretch.duration.value(), s.resolution.value(), median_floor(s.floor_nm));
    text += line_table(s.peaks);
    if (one.stretch.smears_orders())
        text += fmt::format(
            "The speed changes ({:.3g} deg/s, give or take {:.2g}, over the angle turned), so that what "
            "turns with the\njoint is no line here: --domain order counts it by output turn.\n",
            one.stretch.turning_deg_s, one.stretch.turning_spread_deg_s);
    return text;
}

std::string order_peaks(const OrderSpectrum& spectrum) {
    const MotionLines& found = spectrum.lines;
    std::string text = spectrum.doubt.empty() ? "" : fmt::format("Cannot tell: {}.\n", spectrum.doubt);
    text += fmt::format("{} in {} over {:.3g} output turns (resolution {:.3g} orders, floor {:.2g} Nm).\n",
                        found.lines.empty() ? "No line" : how_many(found.lines.size(), "line"),
                        how_many(found.sweeps, "sweep"), found.turns, found.resolution_orders,
                        median_floor(spectrum.stack.floor_nm));
    if (found.lines.empty()) return text;
    TextRows rows{{"kind", "output order", "+/-", "Hz", "amplitude, Nm", "SNR"}};
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

}  // namespace

LogSpectrum streamed_spectrum(LogPasses& log, const SpectrumOptions& options,
                              const std::function<void()>& tell) {
    log.first();
    const LogFacts& facts = log.facts();
    const Hertz sample_rate = log.log().trace.sample_rate;
    const std::size_t length = piece_length(facts.rows, sample_rate, options);
    std::optional<SpectrumStream> stream;
    if (length >= fewest_spectrum_samples) stream.emplace(length, sample_rate);
    StretchMeter speed(facts.rows, Seconds(facts.mean_s), Degrees(facts.mean_position_deg));
    log.second([&](const TraceView& rows) {
        speed.add(rows);
        if (stream) stream->add(rows.time_s, rows.torque_nm);
    });
    tell();
    require_piece_length(length, options);
    return {speed.stretch(sample_rate), stream->spectrum(options.false_alarm)};
}

namespace {

constexpr std::array<std::string_view, 2> map_names = {"campbell", "order"};
constexpr std::array<std::string_view, 2> domain_names = {"frequency", "order"};

struct SpectrumRequest : LogRequest {
    std::string domain = "frequency";
    std::optional<Seconds> segment;
    double false_alarm = 0.01;
    std::optional<std::string> map;  ///< --map: "campbell" or "order"
    std::optional<double> resolution, highest;
    std::optional<DegPerSec> speed_step;
    TrackRequest track;
    ResidualOptions residual;
    bool bins = false;

    /// Frequencies of all of the log are the same however the joint moves.
    [[nodiscard]] bool needs_motion() const { return map || residual.any() || domain != "frequency"; }
    /// Numbers by the thousand, and no table for people.
    [[nodiscard]] bool is_csv() const {
        return !common.json && (map || bins || common.output.ends_with(".csv"));
    }
    /// Half-overlapping pieces of all of the log, which need no more of it at a time.
    [[nodiscard]] bool in_pieces() const { return segment && !needs_motion(); }
};

// One row a cell: speed_deg_s, then frequency_hz, order (with a gear ratio) or order_output, then
// amplitude_nm.
std::string map_csv(const SpeedMap& map, std::string_view axis_name) {
    std::string text = fmt::format("speed_deg_s,{},amplitude_nm\n", axis_name);
    for (std::size_t row = 0; row < map.speed_deg_s.size(); ++row) {
        const std::string speed = fmt::format("{:.6g}", map.speed_deg_s[row]);
        for (std::size_t k = 0; k < map.axis.size(); ++k) {
            text += fmt::format("{},{:.6g},{:.6g}\n", speed, map.axis[k], map.amplitude_nm[row][k]);
        }
    }
    return text;
}

std::string in_words(const SpeedMap& map, std::string_view unit, std::optional<double> asked) {
    std::string text =
        fmt::format("{} speeds in steps of {} deg/s, resolution {:.3g} {}", map.speed_deg_s.size(),
                    shortest(map.speed_step_deg_s), map.resolution, unit);
    if (asked && map.resolution > 1.001 * *asked)
        text += fmt::format(" instead of {}: no run of motion is long enough", shortest(*asked));
    return text;
}

// Throws UsageError when options of the map are given without --map, or make no sense.
void check_speed_map(const SpectrumRequest& request) {
    const bool of_track = request.gear.any() || request.speed_step;
    if (!request.map && ((!request.track.wanted && of_track) || request.resolution || request.highest))
        raise<UsageError>(
            "--joint-file, --gear-ratio, --orders and --speed-step belong to --map and --track, and "
            "--resolution and --highest to --map");
    if (request.map && *request.map != map_names[0] && *request.map != map_names[1])
        raise<UsageError>("--map: '{}' is none of campbell, order", *request.map);
    check_gear(request.gear);
}

// The lines that are drawn into the map, where a gear is known; notes the joint file as an input.
MapLines map_lines(const SpectrumRequest& request, Provenance& provenance) {
    const GearChoice choice(request.gear);
    if (choice.joint()) provenance.inputs.push_back(input_record(choice.joint()->path));
    MapLines lines{choice.of(), false};
    lines.axis_per_motor_turn = lines.gear && !lines.gear->per_turn && *request.map == "order";
    return lines;
}

Answer map_answer(const SpectrumRequest& request, const MapLines& lines, const Trace& trace,
                  const Provenance& provenance) {
    const bool campbell = *request.map == "campbell";
    const TraceView view = trace.view();
    OutputAngle angle = output_angle(view);
    for (double& turns : angle.turns) turns *= lines.gear ? lines.gear->ratio.value() : 1.0;
    const std::vector<double> speed = smoothed_speed(view);
    SpeedMap map = speed_map(view, angle.turns, speed,
                             {.axis = campbell ? Axis::time : Axis::angle,
                              .resolution = request.resolution,
                              .highest = request.highest,
                              .speed_step = request.speed_step.value_or(DegPerSec(0.0))});
    const std::string_view axis = campbell                    ? "frequency_hz"
                                  : lines.axis_per_motor_turn ? "order"
                                                              : "order_output";
    const std::string words = in_words(map, campbell ? "Hz" : "orders", request.resolution);
    if (request.resolution && map.resolution > 1.001 * *request.resolution)
        warn(request.common, words);
    else
        say(request.common, words);
    const auto found = std::make_shared<const SpeedMap>(std::move(map));
    return {
        .text = request.is_csv() ? map_csv(*found, axis) : "",
        .document =
            [=, joint = trace.joint] { return speed_map_text(joint, *found, axis, lines.gear, provenance); },
        .figure = [=, source = joint_in_words(
                          request.path, trace.joint)] { return speed_map_figure(source, *found, lines); }};
}

Answer order_answer(const SpectrumRequest& request, const TraceView& trace, const std::string& joint,
                    const std::string& doubt, const Provenance& provenance) {
    if (request.segment) raise<UsageError>("--segment belongs to --domain frequency");
    MotionLinesOptions options;
    options.false_alarm = request.false_alarm;
    const OrderSpectrum result{stack_sweeps(cut_sweeps({&trace, 1}, options.sweeps).pieces),
                               find_motion_lines({&trace, 1}, options), doubt};
    if (result.lines.sweeps == 0) {
        raise<DataError>(
            "{}: the joint nowhere moves {} output turns in one direction, so there is no order spectrum",
            request.path, shortest(options.sweeps.shortest_turns));
    }
    const auto found = std::make_shared<const OrderSpectrum>(result);
    return {.text = request.is_csv() ? order_csv(result.stack) : order_peaks(result),
            .document =
                [=, false_alarm = request.false_alarm] {
                    return order_spectrum_text(joint, *found, false_alarm, provenance);
                },
            .figure =
                [=, source = joint_in_words(request.path, joint)] {
                    return order_spectrum_figure(source, found->stack, found->lines);
                }};
}

// A piece that is longer than what there is is all of it.
void say_segment(const SpectrumRequest& request, const Spectrum& spectrum) {
    constexpr double rounding = 1.01;  // of the piece's length to whole samples
    const double piece_s = spectrum.piece_duration.value();
    if (!request.segment || request.segment->value() <= rounding * piece_s) return;
    warn(request.common, fmt::format("--segment {} s: the log is {:.4g} s long, so all of it is one piece",
                                     shortest(request.segment->value()), piece_s));
}

Answer frequency_answer(const SpectrumRequest& request, LogSpectrum found, const std::string& joint,
                        const Provenance& provenance) {
    say_segment(request, found.spectrum);
    if (request.is_csv() && request.common.verbose && !request.common.quiet)
        talk_lines(frequency_peaks(found));
    const auto made = std::make_shared<const LogSpectrum>(std::move(found));
    return {.text = request.is_csv() ? frequency_csv(made->spectrum) : frequency_peaks(*made),
            .document =
                [=, false_alarm = request.false_alarm] {
                    return spectrum_text(joint, *made, false_alarm, provenance);
                },
            .figure =
                [=, source = joint_in_words(request.path, joint)] {
                    return spectrum_figure(source, made->spectrum, made->stretch.smears_orders());
                }};
}

/// The log goes by and is not held.
Answer piecewise_answer(const SpectrumRequest& request, Provenance& provenance) {
    ReadOptions reading = request.log;
    reading.needs_velocity = false;
    LogPasses log(request.path, reading);
    LogSpectrum spectrum = streamed_spectrum(log, {request.segment, request.false_alarm}, [&] {
        say_layout(request.common, log.log().layout);
        say_warnings(request.common, log.log().recording.warnings);
    });
    provenance.inputs.push_back(input_record(request.path));
    provenance.recordings.push_back({log.log().recording});
    return frequency_answer(request, std::move(spectrum), log.log().layout.chosen.joint, provenance);
}

Answer whole_answer(const SpectrumRequest& request, Provenance& provenance) {
    const MapLines lines = request.map ? map_lines(request, provenance) : MapLines{};
    if (lines.gear) say(request.common, gear_in_words(*lines.gear));
    ReadOptions reading = read_options(request.log, lines.gear);
    take_joint_of(request.residual, reading.joint);
    reading.needs_velocity = request.needs_motion();
    Log log = read_log(request.path, reading);
    say_layout(request.common, log.layout);
    take_residual(request.residual, reading, 1, {request.path, log}, request.common, provenance);
    say_warnings(request.common, log.recording.warnings);
    provenance.inputs.insert(provenance.inputs.begin(), input_record(request.path));
    provenance.recordings.push_back({log.recording});
    const bool by_order = request.domain == "order" || request.map == "order";
    const std::string doubt =
        by_order ? reading_doubt({&log, 1}, [](const OtherReading&) { return true; }) : "";
    if (!doubt.empty()) warn(request.common, doubt);
    if (request.map) return map_answer(request, lines, log.trace, provenance);
    const TraceView trace = log.trace.view();
    if (request.domain == "order") return order_answer(request, trace, log.trace.joint, doubt, provenance);
    return frequency_answer(
        request, {whole_log(trace), torque_spectrum(trace, {request.segment, request.false_alarm})},
        log.trace.joint, provenance);
}

Answer spectrum_of_joint(const SpectrumRequest& request, const std::string& command_line) {
    Provenance provenance{{}, command_line};
    Answer answer =
        request.in_pieces() ? piecewise_answer(request, provenance) : whole_answer(request, provenance);
    const std::string unit = provenance.recordings.front().torque_unit;
    if (request.is_csv())
        answer.kind = Answer::Text::rows;
    else
        answer.text = in_torque_unit(std::move(answer.text), unit);
    answer.document = [document = std::move(answer.document), unit] {
        return in_torque_unit(document(), unit);
    };
    answer.provenance = std::move(provenance);
    return answer;
}

Answer run_spectrum(SpectrumRequest& request, const std::string& command_line) {
    if (!(request.false_alarm > 0.0) || request.false_alarm > 0.5) {
        raise<UsageError>("--false-alarm {} is not between 0 and 0.5", shortest(request.false_alarm));
    }
    request.track.speed_step = request.speed_step;
    check_speed_map(request);
    check_track(request.track);
    const bool of_spectrum = request.segment || request.bins || request.domain != "frequency";
    if (request.track.wanted) {
        if (request.map || of_spectrum || request.residual.any())
            raise<UsageError>(
                "--track goes with neither --domain, --segment, --map, --bins, --residual nor --simulated");
        check_output_name(request.common.output, "a track", ".csv .txt .npy .json");
        static_cast<LogRequest&>(request.track) = request;
        return run_track(request.track, command_line);
    }
    check_output_name(request.common.output, "a spectrum", ".csv .txt .json");
    if (request.map && of_spectrum)
        raise<UsageError>("--map goes with neither --domain, --segment nor --bins");
    if (request.bins) check_output_name(request.common.output, "a table of bins", ".csv .txt");
    if (request.bins && request.common.json)
        raise<UsageError>("--bins and --json: the bins are CSV, and not the lines; give one of them");
    take_joint_of(request.residual, request.log.joint);
    return ask_joints(request, "spectra",
                      [&](const SpectrumRequest& one) { return spectrum_of_joint(one, command_line); });
}

std::function<Answer()> attach_spectrum(Options& options) {
    const auto request = std::make_shared<SpectrumRequest>();
    options.argument("LOG", request->path, true, "a log; - is standard input");
    options.choice("--domain", request->domain, domain_names,
                   "against frequency, or against cycles per output turn");
    options.number("--segment", request->segment, Dimension::time,
                   "average half-overlapping pieces of this length (Welch)", true);
    options.flag("--bins", request->bins,
                 "every bin as CSV instead of a table of the lines; as with -o FILE.csv");
    options.number("--false-alarm", request->false_alarm, Dimension::none,
                   "chance that noise gives any line in a spectrum");
    options.text("--map", request->map, "campbell|order",
                 "over speed: frequency against speed, or order against speed");
    attach_gear(
        options, request->gear,
        {.ratio = "motor turns per joint turn; --map order counts orders per motor turn with it",
         .orders = "orders that --track measures and --map draws, in cycles per motor turn (default: 1,2)",
         .joint_file = "joint.json of identify: gear ratio and orders from there"});
    options.number("--resolution", request->resolution, Dimension::none, "of the map, in Hz or orders", true);
    options.number("--highest", request->highest, Dimension::none, "frequency or order where the map ends",
                   true);
    options.number("--speed-step", request->speed_step, Dimension::speed,
                   "width of a row of the map, or of --track --against speed; about 24 rows when left out",
                   true);
    attach_track(options, request->track);
    attach_residual(options, request->residual);
    attach_plot(options, request->common);
    attach_log(options, request->log);
    attach_common(options, request->common, {"a spectrum", ".csv .txt .npy .json", true});
    return [request, &options] { return run_spectrum(*request, options.command_line()); };
}

}  // namespace

const Command commands::spectrum{
    .name = "spectrum",
    .summary = "amplitude of the torque against frequency or output order",
    .description =
        "Prints the lines that rise above the noise; with --bins, or -o FILE.csv, every bin as CSV "
        "(frequency_hz, amplitude_nm,\npsd_nm2_hz, floor_nm). Amplitudes are zero to peak in Nm, whatever "
        "the window and the length.\nWith --track: time_s, speed_deg_s, and per line amplitude, phase and "
        "standard error.\nExample: ripplenotch spectrum log.csv",
    .attach = attach_spectrum,
};

}  // namespace ripplenotch
