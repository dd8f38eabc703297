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
#include "cli/options/plot_request.hpp"
#include "cli/options/verdict_options.hpp"
#include "cli/spectrum/response.hpp"
#include "cli/talk.hpp"
#include "ripplenotch/analysis/order_map.hpp"
#include "ripplenotch/analysis/spectrum.hpp"
#include "ripplenotch/analysis/sweeps.hpp"
#include "ripplenotch/chart/spectrum_figure.hpp"
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

std::string counted(std::size_t count, std::string_view noun) {
    return count == 0 ? fmt::format("no {}", noun) : how_many(count, noun);
}

std::string line_table(const std::vector<SpectralPeak>& peaks) {
    if (peaks.empty()) return "";
    std::vector<std::vector<std::string>> rows{{"Hz", "+/-", "amplitude, Nm", "phase, deg", "SNR"}};
    for (const SpectralPeak& peak : peaks) {
        rows.push_back({fmt::format("{:.4f}", peak.hz), fmt::format("{:.2g}", peak.hz_stderr),
                        fmt::format("{:.4g}", peak.amplitude_nm), fmt::format("{:.1f}", peak.phase_deg),
                        fmt::format("{:.1f}", peak.snr)});
    }
    return text_table(rows, "r");
}

std::string hump_table(const std::vector<SpectralHump>& humps) {
    if (humps.empty()) return "";
    std::vector<std::vector<std::string>> rows{
        {"hump, Hz", "rms in it, Nm", "highest at, Hz", "amplitude, Nm", "noise, Nm"}};
    for (const SpectralHump& hump : humps) {
        rows.push_back({fmt::format("{:.4g} to {:.4g}", hump.from_hz, hump.to_hz),
                        fmt::format("{:.3g}", hump.rms_nm), fmt::format("{:.4g}", hump.peak_hz),
                        fmt::format("{:.3g}", hump.peak_nm), fmt::format("{:.2g}", hump.floor_nm)});
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

// The bins as CSV; several spectra with their number and speed in front.
std::string frequency_csv(const std::vector<StretchSpectrum>& spectra) {
    const bool numbered = spectra.front().number.has_value();
    std::string text = numbered ? "stretch,speed_deg_s,frequency_hz,amplitude_nm,psd_nm2_hz,floor_nm\n"
                                : "frequency_hz,amplitude_nm,psd_nm2_hz,floor_nm\n";
    for (const StretchSpectrum& one : spectra) {
        const Spectrum& s = one.spectrum;
        const double amplitude_nm = largest_of(s.amplitude_nm), psd = largest_of(s.psd_nm2_hz);
        for (std::size_t k = 0; k < s.hz.size(); ++k) {
            if (numbered) {
                text += std::to_string(*one.number) + ",";
                append_shortest(text, one.stretch.speed.value());
                text += ",";
            }
            append_cells(text,
                         {s.hz[k], to_digits_in_row({s.amplitude_nm[k], amplitude_nm}),
                          power_cell(psd, s.psd_nm2_hz[k]), to_digits_in_row({s.floor_nm[k], amplitude_nm})});
        }
    }
    return text;
}

std::string order_csv(const Stack& stack) {
    std::string text = "order_output,amplitude_nm,floor_nm,averages\n";
    const double amplitude_nm = largest_of(stack.amplitude_nm);
    for (std::size_t k = stack.first; k < stack.ratio.size(); ++k) {
        append_cells(text, {static_cast<double>(k) * stack.spacing,
                            to_digits_in_row({stack.amplitude_nm[k], amplitude_nm}),
                            to_digits_in_row({stack.floor_nm[k], amplitude_nm}), stack.averages[k]});
    }
    return text;
}

// The lines as tables.
std::string frequency_peaks(const std::vector<StretchSpectrum>& spectra) {
    std::string text;
    for (const StretchSpectrum& one : spectra) {
        const Spectrum& s = one.spectrum;
        if (!text.empty()) text += "\n";
        text += one.number ? fmt::format("Stretch {}, {:.4g} deg/s: ", *one.number, one.stretch.speed.value())
                           : "";
        const std::string humps = s.humps.empty() ? "" : " and " + counted(s.humps.size(), "hump");
        text += fmt::format("{}{} in {:.4g} s (resolution {:.3g} Hz, floor {:.2g} Nm).\n",
                            counted(s.peaks.size(), "line"), humps, one.stretch.duration.value(),
                            s.resolution.value(), median_floor(s.floor_nm));
        text += line_table(s.peaks) + hump_table(s.humps);
        if (one.stretch.smears_orders())
            text += fmt::format(
                "The speed changes ({:.3g} deg/s, give or take {:.2g}, over the angle turned), so that "
                "what turns with the\njoint is no line here: --domain order counts it by output turn.\n",
                one.stretch.turning_deg_s, one.stretch.turning_spread_deg_s);
    }
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

/// Pieces are cut in the first pass already, at the rate that the first rows have. Longer ones wait until it
/// is known that the log is as long.
constexpr std::size_t longest_guessed = std::size_t{1} << 17;

class GuessedSpectrum {
  public:
    explicit GuessedSpectrum(const SpectrumOptions& options) : options_(options) {}

    void add(const TraceView& rows) {
        if (length_ == 0) length_ = begin(rows);
        if (stream_) stream_->add(rows.time_s, rows.torque_nm);
    }
    /// What the first pass has added up, when the guess was good enough to make no difference.
    [[nodiscard]] std::optional<SpectrumStream> settled(std::size_t length, Hertz rate) {
        if (!stream_ || length_ != length || !stream_->settle(rate)) return std::nullopt;
        return std::move(stream_);
    }

  private:
    std::size_t begin(const TraceView& rows) {
        const double duration = rows.time_s.back() - rows.time_s.front();
        const Hertz rate = nominal_rate(Hertz(static_cast<double>(rows.size() - 1) / duration));
        const bool known = duration > 0.0;
        const std::size_t length = known ? piece_length(longest_guessed + 1, rate, options_) : 1;
        if (known && length >= fewest_spectrum_samples && length <= longest_guessed)
            stream_.emplace(length, rate);
        return length;
    }

    SpectrumOptions options_;
    std::size_t length_ = 0;
    std::optional<SpectrumStream> stream_;
};

}  // namespace

StretchSpectrum streamed_spectrum(LogPasses& log, const SpectrumOptions& options,
                                  const std::function<void()>& tell) {
    GuessedSpectrum guess(options);
    log.first([&](const TraceView& rows) { guess.add(rows); });
    const LogFacts& facts = log.facts();
    const std::size_t length = piece_length(facts.rows, facts.sample_rate, options);
    const bool enough = length >= fewest_spectrum_samples;
    std::optional<SpectrumStream> stream = guess.settled(length, facts.sample_rate);
    const bool added = stream.has_value(), lines = added && stream->find_lines(options.false_alarm);
    if (enough && !added) stream.emplace(length, facts.sample_rate);

    StretchMeter speed(facts.rows, Seconds(facts.mean_s), Degrees(facts.mean_position_deg));
    log.second([&](const TraceView& rows) {
        speed.add(rows);
        if (enough && !added) stream->add(rows.time_s, rows.torque_nm);
        if (lines) stream->measure(rows.time_s, rows.torque_nm);
    });
    tell();
    require_piece_length(length, options);
    if (!added && stream->find_lines(options.false_alarm))
        log.again([&](const TraceView& rows) { stream->measure(rows.time_s, rows.torque_nm); });
    return {std::nullopt, speed.stretch(facts.sample_rate), stream->spectrum()};
}

namespace {

// spectrum --map: its options, and the map as CSV or JSON.

struct SpeedMapRequest {
    std::optional<std::string> map;  ///< "campbell" or "order"; nothing without it
    GearOptions gear;
    std::optional<double> resolution, highest;
    std::optional<DegPerSec> speed_step;
};

/// CSV, one row a cell: speed_deg_s, then frequency_hz, order (with a gear ratio) or order_output, then
/// amplitude_nm. JSON: schema ripplenotch/spectrum/1.
struct SpeedMapResult {
    std::string text;
    SpeedMap map;
};

constexpr std::array<std::string_view, 2> map_names = {"campbell", "order"};

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

void attach_speed_map(Options& options, SpeedMapRequest& request) {
    options.text("--map", request.map, "campbell|order",
                 "over speed: frequency against speed, or order against speed");
    attach_gear(
        options, request.gear,
        {.ratio = "--map order: count orders per motor turn instead of per output turn; --method needs it",
         .orders = "--map: orders whose lines are drawn, in cycles per motor turn (default: 1,2)",
         .joint_file = "--map: joint.json with gear ratio and orders"});
    options.number("--resolution", request.resolution, Dimension::none,
                   "of the map, in Hz or orders; of --response in Hz");
    options.number("--highest", request.highest, Dimension::none, "frequency or order where the map ends");
    options.number("--speed-step", request.speed_step, Dimension::speed, "width of a row of the map");
}

// Throws UsageError when options of the map are given without --map, or make no sense.
void check_speed_map(const SpeedMapRequest& request, bool of_response) {
    const bool shared = request.gear.any() || request.resolution;
    if (!request.map && ((shared && !of_response) || request.highest || request.speed_step)) {
        raise<UsageError>(
            "--joint-file, --gear-ratio, --orders, --resolution, --highest and --speed-step belong to --map");
    }
    if (request.map && *request.map != map_names[0] && *request.map != map_names[1])
        raise<UsageError>("--map: '{}' is none of campbell, order", *request.map);
    const auto positive = [](std::string_view option, std::optional<double> value) {
        if (value && !(*value > 0.0)) raise<UsageError>("{} {} is not above 0", option, shortest(*value));
    };
    check_gear(request.gear);
    positive("--resolution", request.resolution);
    positive("--highest", request.highest);
    if (request.speed_step) positive("--speed-step", request.speed_step->value());
}

// The lines that are drawn into the map, where a gear is known; notes the joint file as an input.
MapLines map_lines(const SpeedMapRequest& request, Provenance& provenance) {
    const GearChoice choice(request.gear);
    if (choice.joint()) provenance.inputs.push_back(input_record(choice.joint()->path));
    MapLines lines{choice.of(), false};
    if (!lines.gear && !request.gear.orders.empty()) raise_no_gear("--orders");
    lines.axis_per_motor_turn = lines.gear && *request.map == "order";
    return lines;
}

SpeedMapResult speed_map_result(const SpeedMapRequest& request, const MapLines& lines, const Trace& trace,
                                const CommonOptions& common, const Provenance& provenance) {
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
    const std::string_view axis = campbell ? "frequency_hz" : lines.gear ? "order" : "order_output";
    const std::string words = in_words(map, campbell ? "Hz" : "orders", request.resolution);
    if (request.resolution && map.resolution > 1.001 * *request.resolution) {
        warn(common, words);
    } else {
        say(common, words);
    }
    std::string text =
        common.json ? speed_map_text(trace.joint, map, axis, lines.gear, provenance) : map_csv(map, axis);
    return {std::move(text), std::move(map)};
}

constexpr std::array<std::string_view, 2> domain_names = {"frequency", "order"};

struct SpectrumRequest {
    CommonOptions common;
    ReadOptions log;
    std::string path, domain = "frequency";
    std::optional<std::string> stretch;
    std::optional<Seconds> segment;
    double false_alarm = 0.01;
    SteadyRule steady;
    SpeedMapRequest map;
    ResidualOptions residual;
    ResponseRequest response;
    PlotRequest plot;
    bool peaks = false, bins = false;

    /// Frequencies of all of the log are the same however the joint moves.
    [[nodiscard]] bool needs_motion() const {
        return stretch || map.map || residual.any() || domain != "frequency" ||
               (response.signals && response.needs_motion(map.gear));
    }
    /// Numbers by the thousand, and no table for people.
    [[nodiscard]] bool is_csv() const {
        return !common.json && (map.map || bins || common.output.ends_with(".csv"));
    }
    /// Half-overlapping pieces of all of the log, which need no more of it at a time.
    [[nodiscard]] bool in_pieces() const { return segment && !needs_motion() && !response.signals; }
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
                       : request.is_csv() ? order_csv(result.stack)
                                          : order_peaks(result);
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
    warn(request.common, fmt::format("--segment {} s: {} is {:.4g} s long, so all of it is one piece",
                                     shortest(request.segment->value()), what, piece_s));
}

Result frequency_result(const SpectrumRequest& request, std::vector<StretchSpectrum> spectra,
                        const std::string& joint, const Provenance& provenance) {
    for (const StretchSpectrum& one : spectra) say_segment(request, one);
    if (request.is_csv() && request.common.verbose && !request.common.quiet)
        talk_lines(frequency_peaks(spectra));
    std::string text = request.common.json ? spectra_text(joint, spectra, request.false_alarm, provenance)
                       : request.is_csv()  ? frequency_csv(spectra)
                                           : frequency_peaks(spectra);
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

Result response_result(const SpectrumRequest& request, const ResponseLog& read,
                       const Provenance& provenance) {
    ResponseReport report = response_report(request.response, request.map.gear, read);
    std::string text = request.common.json ? response_text(report, provenance)
                       : request.is_csv()  ? response_csv(report)
                                           : response_table(report);
    if (request.is_csv()) say(request.common, response_verdict(report));
    return {std::move(text),
            [report = std::move(report), source = joint_in_words(request.path, read.log.trace.joint)] {
                return response_figure(source, report);
            }};
}

using Made = std::pair<Result, Provenance>;

/// The log goes by and is not held.
Made piecewise_result(const SpectrumRequest& request, const std::string& command_line) {
    ReadOptions reading = request.log;
    reading.needs_velocity = false;
    LogPasses log(request.path, reading);
    const StretchSpectrum spectrum = streamed_spectrum(log, {request.segment, request.false_alarm}, [&] {
        say_layout(request.common, log.layout());
        say_warnings(request.common, log.recording().warnings);
    });
    const Provenance provenance{{input_record(request.path)}, command_line, {{log.recording()}}};
    return {frequency_result(request, {spectrum}, log.layout().chosen.joint, provenance), provenance};
}

Made whole_result(const SpectrumRequest& request, const std::string& command_line) {
    Provenance provenance{{}, command_line};
    const MapLines lines = request.map.map ? map_lines(request.map, provenance) : MapLines{};
    if (lines.gear) say(request.common, gear_in_words(*lines.gear));
    ReadOptions reading = read_options(request.log, lines.gear);
    take_joint_of(request.residual, reading.joint);
    reading.needs_velocity = request.needs_motion();
    reading.needs_torque = !request.response.signals || request.response.names("torque");
    Log log = read_log(request.path, reading);
    say_layout(request.common, log.layout);
    take_residual(request.residual, reading, 1, {request.path, log}, request.common, provenance);
    say_warnings(request.common, log.recording.warnings);
    provenance.inputs.insert(provenance.inputs.begin(), input_record(request.path));
    provenance.recordings.push_back({log.recording});
    if (request.response.signals)
        return {response_result(request, {request.path, reading, log}, provenance), provenance};
    const bool by_order = request.domain == "order" || request.map.map == "order";
    const std::string doubt =
        by_order ? reading_doubt({&log, 1}, [](const OtherReading&) { return true; }) : "";
    if (!doubt.empty()) warn(request.common, doubt);
    if (request.map.map) return {map_result(request, lines, log.trace, provenance), provenance};
    const TraceView trace = log.trace.view();
    if (request.domain == "order")
        return {order_result(request, trace, log.trace.joint, doubt, provenance), provenance};
    return {frequency_result(request, frequency_spectra(request, trace), log.trace.joint, provenance),
            provenance};
}

JointResult spectrum_of_joint(const SpectrumRequest& request, const std::string& command_line) {
    auto [made, provenance] =
        request.in_pieces() ? piecewise_result(request, command_line) : whole_result(request, command_line);
    JointResult result{!request.is_csv()
                           ? in_torque_unit(std::move(made.text), provenance.recordings.front().torque_unit)
                           : std::move(made.text)};
    // A figure in the terminal takes the place of the bins, and not that of the tables.
    if (request.is_csv() && request.plot.instead_of(request.common.output)) result.write = [] {};
    result.afterwards = [request, provenance = std::move(provenance), figure = std::move(made.figure)] {
        draw_plot(request.plot, request.common, provenance, figure);
    };
    return result;
}

void check_response(SpectrumRequest& request) {
    if (!request.response.signals) {
        if (request.response.method || request.response.estimator != "h1")
            raise<UsageError>("--method and --estimator belong to --response");
        return;
    }
    if (request.map.map || request.stretch || request.peaks || request.bins || request.domain != "frequency")
        raise<UsageError>("--response goes with neither --domain, --stretch, --map, --peaks nor --bins");
    if (request.segment && request.map.resolution)
        raise<UsageError>(
            "--segment and --resolution state the same, 1.5 over one is the other: leave one out");
    request.response.segment = request.segment;
    if (request.map.resolution) request.response.resolution = Hertz(*request.map.resolution);
    if (request.map.gear.any() && !request.response.method)
        raise<UsageError>("--gear-ratio, --orders and --joint-file belong to --method and to --map");
}

ExitCode run_spectrum(SpectrumRequest& request, const std::string& command_line) {
    if (!(request.false_alarm > 0.0) || request.false_alarm > 0.5) {
        raise<UsageError>("--false-alarm {} is not between 0 and 0.5", shortest(request.false_alarm));
    }
    check_speed_map(request.map, request.response.signals.has_value());
    check_response(request);
    hash_where_told(request.common, request.plot);
    if (request.map.map && (request.stretch || request.segment || request.peaks || request.bins ||
                            request.domain != "frequency"))
        raise<UsageError>("--map goes with neither --domain, --stretch, --segment, --peaks nor --bins");
    if (request.peaks) check_output_name(request.common.output, "a table of lines", ".txt .json");
    if (request.bins) check_output_name(request.common.output, "a table of bins", ".csv .txt");
    if (request.bins && (request.peaks || request.common.json))
        raise<UsageError>("--bins and {}: the bins are CSV, and not the lines; give one of them",
                          request.peaks ? "--peaks" : "--json");
    ReadOptions log = request.log;
    take_joint_of(request.residual, log.joint);
    const std::string_view documents = request.response.signals ? "responses" : "spectra";
    return run_joints({request.path, log, request.common, &request.plot, documents, request.is_csv()},
                      [&](const std::optional<std::string>& joint, const CommonOptions& common) {
                          SpectrumRequest one = request;
                          one.common = common;
                          if (joint) one.log.joint = joint;
                          one.plot.path = of_joint(request.plot.path, joint);
                          one.map.gear.joint_file = of_joint(request.map.gear.joint_file, joint);
                          return spectrum_of_joint(one, command_line);
                      });
}

std::function<ExitCode()> attach_spectrum(Options& options) {
    const auto request = std::make_shared<SpectrumRequest>();
    options.argument("LOG", request->path, true, "a log; - is standard input");
    options.choice("--domain", request->domain, domain_names,
                   "against frequency, or against cycles per output turn");
    options.text("--stretch", request->stretch, "all|NUMBER",
                 "steady stretches instead of the whole log, each or one of them");
    options.number("--segment", request->segment, Dimension::time,
                   "average half-overlapping pieces of this length (Welch)", true);
    options.flag("--bins", request->bins,
                 "every bin as CSV instead of tables of the lines and humps; as with -o FILE.csv");
    options.flag("--peaks", request->peaks, "these tables, which are the default");
    options.number("--false-alarm", request->false_alarm, Dimension::none,
                   "chance that noise gives any line in a spectrum");
    options.number("--steady-band", request->steady.band_percent, Dimension::none,
                   "a stretch is steady while its speed stays within this many per cent ...");
    options.number("--steady-band-speed", request->steady.band_deg_s, Dimension::speed,
                   "... or within this speed, whichever is wider; none by default");
    options.number("--steady-for", request->steady.at_least, Dimension::time, "for at least this long", true);
    attach_speed_map(options, request->map);
    attach_response(options, request->response);
    attach_residual(options, request->residual);
    attach_plot(options, request->plot, request->common);
    attach_log(options, request->log);
    attach_common(options, request->common, {"a spectrum", ".csv .txt .json", true});
    return [request, &options] { return run_spectrum(*request, options.command_line()); };
}

}  // namespace

const Command commands::spectrum{
    .name = "spectrum",
    .summary = "amplitude of the torque against frequency or output order",
    .description =
        "Prints the lines that rise above the noise; with --bins, or -o FILE.csv, every bin as CSV "
        "(frequency_hz, amplitude_nm,\npsd_nm2_hz, floor_nm). Amplitudes are zero to peak in Nm, whatever "
        "the window and the length.\nExample: ripplenotch spectrum log.csv",
    .attach = attach_spectrum,
};

}  // namespace ripplenotch
