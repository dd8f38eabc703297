// SPDX-License-Identifier: MIT
// ripplenotch track: amplitude and phase of each order against time or speed.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "cli/command.hpp"
#include "cli/options/joint_runs.hpp"
#include "cli/options/plot_request.hpp"
#include "cli/options/verdict_options.hpp"
#include "cli/talk.hpp"
#include "ripplenotch/analysis/sweeps.hpp"
#include "ripplenotch/analysis/track_report.hpp"
#include "ripplenotch/analysis/vold_kalman.hpp"
#include "ripplenotch/chart/track_figure.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/document/spectrum_json.hpp"
#include "ripplenotch/log/log.hpp"
#include "ripplenotch/verdict/gear_choice.hpp"
#include "ripplenotch/verdict/readings.hpp"

namespace ripplenotch {

namespace {

// What `track` says of rows that it could not measure.

std::vector<std::string> track_warnings(const TrackReport& report) {
    const OrderTracks& tracks = report.tracks;
    std::vector<std::string> warnings;
    if (!report.angle_from_position) {
        warnings.emplace_back(
            "no usable position: the angle is integrated velocity, and phases count from the first sample");
    }
    if (tracks.windows_too_few_samples > 0) {
        warnings.push_back(fmt::format("{} left out: too few samples for so many lines; use a longer window",
                                       how_many(tracks.windows_too_few_samples, "window")));
    }
    if (tracks.rows_not_separable > 0) {
        warnings.push_back(fmt::format(
            "{} rows where lines cannot be distinguished from each other or from the trend are {}",
            tracks.rows_not_separable, report.method == "ls" ? "left out" : "nan or left out"));
    }
    if (tracks.rows_folded > 0) {
        warnings.push_back(
            fmt::format("in {} rows a line lies above half the sample rate: its amplitude is what a "
                        "low-pass before the sampling left of it",
                        tracks.rows_folded));
    }
    return warnings;
}

// Why no row at all could be measured.
std::string why_nothing_tracked(const TrackReport& report) {
    if (report.bandwidth) {
        return fmt::format(
            "no line anywhere turns faster than four times the bandwidth of {} Hz, apart from the others",
            shortest(report.bandwidth->value()));
    }
    const std::string window = report.window ? shortest(report.window->value()) + " s"
                                             : shortest(report.window_turns.value_or(0.0)) + " turns";
    return fmt::format("the joint nowhere moves in one direction for a window of {}, or for half of one",
                       window);
}

constexpr std::array<std::string_view, 2> method_names = {"ls", "vold-kalman"};
constexpr std::array<std::string_view, 3> amplitude_names = {"peak", "rms", "peak-to-peak"};
constexpr std::array<std::string_view, 2> against_names = {"time", "speed"};

struct TrackRequest {
    CommonOptions common;
    PlotRequest plot;
    ReadOptions log;
    std::string path, method = "ls", amplitude = "peak", against = "time";
    std::vector<double> output_orders, tones_hz;
    GearOptions gear_options;
    std::optional<GearAccount> gear;  ///< chosen
    std::optional<double> window_turns;
    std::optional<Seconds> window;
    std::optional<Hertz> bandwidth, rows_per_second;
    std::optional<DegPerSec> speed_step;
    int poles = 2;
};

bool by_vold_kalman(const TrackRequest& request) { return request.method == "vold-kalman"; }

void check_track(const TrackRequest& request) {
    const bool vold_kalman = by_vold_kalman(request);
    if (vold_kalman && (request.window_turns || request.window)) {
        raise<UsageError>("--window and --window-turns belong to --method ls; vold-kalman has a --bandwidth");
    }
    if (!vold_kalman && (request.bandwidth || request.rows_per_second)) {
        raise<UsageError>(
            "--bandwidth and --rows-per-second belong to --method vold-kalman; ls has a --window");
    }
    if (request.window_turns && request.window)
        raise<UsageError>("--window and --window-turns exclude each other");
    if (request.speed_step && request.against != "speed")
        raise<UsageError>("--speed-step belongs to --against speed");
}

void read_gear(TrackRequest& request, Provenance& provenance) {
    const GearChoice choice(request.gear_options);
    if (choice.joint()) provenance.inputs.push_back(input_record(choice.joint()->path));
    request.gear = choice.of();
    const bool orders_stated = !request.gear_options.orders.empty() || request.gear_options.joint_file;
    const bool other_lines = !request.output_orders.empty() || !request.tones_hz.empty();
    // Whoever lists other lines and no orders asks for those lines alone.
    if (request.gear && other_lines && !orders_stated)
        request.gear = GearAccount{request.gear->ratio, {}, {}, {}, "--gear-ratio"};
    if (request.gear) say(request.common, gear_in_words(*request.gear));
    if (!request.gear && !request.gear_options.orders.empty()) raise_no_gear("--orders");
    if (!request.gear && !other_lines) {
        raise<UsageError>(
            "nothing to track; give --gear-ratio, for example 100, --joint-file joint.json, --output-orders, "
            "or --tones");
    }
}

/// The signal that is tracked, with the angles and speeds that it borrows.
struct Prepared {
    OutputAngle angle;
    std::vector<double> motor_turns, speed;
    TrackedSignal signal;
    std::vector<TrackLabel> labels;
    std::vector<double> reference_orders;  ///< of the lines that turn, per turn of the reference shaft
};

std::unique_ptr<Prepared> prepare(const TrackRequest& request, const TraceView& trace) {
    auto p = std::make_unique<Prepared>();
    p->angle = output_angle(trace);
    p->speed = smoothed_speed(trace);
    const double ratio = request.gear ? request.gear->ratio.value() : 1.0;
    p->motor_turns = p->angle.turns;
    for (double& turns : p->motor_turns) turns *= ratio;
    p->signal = {trace.sample_rate, trace.time_s, trace.torque_nm,  p->speed,
                 p->motor_turns,    {},           trace.run_starts, GearRatio(ratio)};
    const auto add = [&](TrackLabel::Kind kind, double value, std::span<const double> turns) {
        p->labels.push_back({kind, value});
        p->signal.lines.push_back({value, turns});
    };
    for (const Order order : request.gear ? request.gear->orders : std::vector<Order>{}) {
        add(TrackLabel::Kind::order, order.value(), p->motor_turns);
        p->reference_orders.push_back(order.value());
    }
    for (const double order : request.output_orders) {
        add(TrackLabel::Kind::order_output, order, p->angle.turns);
        p->reference_orders.push_back(order / ratio);
    }
    for (const double hz : request.tones_hz) add(TrackLabel::Kind::tone, hz, trace.time_s);
    return p;
}

void track_by_least_squares(const TrackRequest& request, const Prepared& prepared, TrackReport& report) {
    WindowRule rule;
    if (request.window) {
        rule.seconds = *request.window;
        report.window = rule.seconds;
    } else if (request.window_turns) {
        rule.turns = *request.window_turns;
    } else if (prepared.reference_orders.empty()) {
        raise<UsageError>("tones alone need --window, for example --window 0.5s");
    } else {
        rule.turns = separating_window_turns(prepared.reference_orders);
    }
    if (!request.window) report.window_turns = rule.turns;
    report.tracks = track_orders(prepared.signal, rule);
}

void track_by_vold_kalman(const TrackRequest& request, const Prepared& prepared, TrackReport& report) {
    VoldKalmanRule rule;
    if (request.bandwidth) rule.bandwidth = *request.bandwidth;
    if (request.rows_per_second) rule.rows_per_second = *request.rows_per_second;
    rule.poles = request.poles;
    VoldKalmanTracks found = track_vold_kalman(prepared.signal, rule);
    report.bandwidth = rule.bandwidth;
    report.bandwidth_obtained = found.bandwidth;
    report.poles = rule.poles;
    report.tracks = std::move(found.tracks);
}

std::vector<NumberColumn> columns_of(const TrackReport& report) {
    std::vector<NumberColumn> columns;
    for (TrackColumn& column : track_columns(report)) {
        if (!column.name.ends_with("time_s")) {
            for (double& value : column.values) value = to_digits(value);
        }
        columns.push_back({column.name, std::move(column.values)});
    }
    return columns;
}

void write_columns(const TrackRequest& request, const TrackReport& report) {
    const LogFormat& format = output_format(request.common.output, std::nullopt);
    const std::vector<NumberColumn> columns = columns_of(report);
    ByteSink sink(request.common.output, request.common.overwrite(), format.binary);
    format.write_columns(sink, columns);
    sink.finish();
}

// The same as text, for the rows of several joints below one another.
std::string csv_of(const TrackReport& report) {
    const std::vector<NumberColumn> columns = columns_of(report);
    std::string text = joined(columns, ",", [](const NumberColumn& column) { return column.name; }) + "\n";
    for (std::size_t row = 0; row < columns.front().values.size(); ++row) {
        for (std::size_t c = 0; c < columns.size(); ++c) {
            if (c > 0) text += ',';
            append_shortest(text, columns[c].values[row]);
        }
        text += '\n';
    }
    return text;
}

Figure figure_of(const TrackRequest& request, const TrackReport& report) {
    std::vector<TrackName> names;
    for (const TrackLabel& label : report.labels) {
        names.push_back({label.words(), {}, label.kind == TrackLabel::Kind::tone});
        if (label.kind == TrackLabel::Kind::order) names.back().order = label.value;
    }
    const TrackScale scale{amplitude_factor(report.kind), request.amplitude == "rms" ? "rms"
                                                          : request.amplitude == "peak-to-peak"
                                                              ? "peak to peak"
                                                              : "amplitude, zero to peak"};
    const std::string source = joint_in_words(request.path, report.joint);
    Figure figure = report.by_speed ? track_figure(source, *report.by_speed, names, scale)
                                    : track_figure(source, report.tracks, names, scale);
    figure.sentence = report.doubt + track_verdict(report);
    return figure;
}

/// All lines that turn are estimated together, as they are tracked.
std::vector<std::optional<RippleEstimate>> ripple_of_lines(const TrackRequest& request,
                                                           const Prepared& prepared, const TraceView& trace) {
    const GearRatio ratio = request.gear ? request.gear->ratio : GearRatio(1.0);
    std::vector<Order> orders;
    for (const double order : prepared.reference_orders) orders.emplace_back(order);
    std::vector<std::optional<RippleEstimate>> found;
    for (RippleEstimate& one : estimate_ripple({&trace, 1}, ratio, orders))
        found.emplace_back(std::move(one));
    found.resize(prepared.labels.size());  // tones come last
    return found;
}

/// A reading under which something turns with the shaft is confirmed by that, unless another one has it, too.
std::string unit_doubt(const TrackRequest& request, const Prepared& prepared, const Log& log) {
    const auto shows = [&](const Prepared& of, const TraceView& trace) {
        const auto found = ripple_of_lines(request, of, trace);
        return std::any_of(found.begin(), found.end(), [](const auto& one) { return one && one->present(); });
    };
    if (prepared.reference_orders.empty()) return "";
    const bool confirmed = shows(prepared, log.trace.view());
    const std::string doubt = reading_doubt({&log, 1}, [&](const OtherReading& reading) {
        const Trace trace = read_otherwise(log.trace, reading);
        return !confirmed || (!reading.changes_side && shows(*prepare(request, trace.view()), trace.view()));
    });
    if (doubt.empty()) return "";
    warn(request.common, doubt);
    return fmt::format("Cannot tell: {}. ", doubt);
}

TrackReport track_report_of(const TrackRequest& request, const Prepared& prepared, const Trace& trace) {
    TrackReport report;
    report.joint = trace.joint;
    report.ripple = ripple_of_lines(request, prepared, trace.view());
    report.method = request.method;
    report.kind = request.amplitude == "rms"            ? AmplitudeKind::rms
                  : request.amplitude == "peak-to-peak" ? AmplitudeKind::peak_to_peak
                                                        : AmplitudeKind::peak;
    report.gear = request.gear;
    report.angle_from_position = prepared.angle.absolute;
    report.labels = prepared.labels;
    try {
        (by_vold_kalman(request) ? track_by_vold_kalman : track_by_least_squares)(request, prepared, report);
    } catch (const DataError& error) {  // the library knows no file
        raise<DataError>("{}: {}", request.path, error.what());
    }
    return report;
}

JointResult track_joint(TrackRequest request, const std::string& command_line, bool one_of_several) {
    Provenance provenance{{}, command_line};
    read_gear(request, provenance);
    const Log log = read_log_in_part(request.path, read_options(request.log, request.gear));
    take_log(request.common, request.path, log, provenance);

    const auto prepared = prepare(request, log.trace.view());
    TrackReport report = track_report_of(request, *prepared, log.trace);
    say_warnings(request.common, track_warnings(report));
    report.doubt = unit_doubt(request, *prepared, log);
    if (report.tracks.time_s.empty())
        raise<DataError>("{}: no row could be measured: {}", request.path, why_nothing_tracked(report));
    if (request.against == "speed")
        report.by_speed = gather_by_speed(report.tracks, request.speed_step.value_or(DegPerSec(0.0)));
    JointResult result;
    if (request.common.json) {
        result.text = in_torque_unit(track_text(report, provenance), log.recording.torque_unit);
    } else {
        say(request.common, in_torque_unit(report.doubt + track_verdict(report), log.recording.torque_unit));
        if (one_of_several) result.text = csv_of(report);
        result.write = [request, report] {
            if (!request.plot.instead_of(request.common.output)) write_columns(request, report);
        };
    }
    result.afterwards = [request, report = std::move(report), provenance] {
        draw_plot(request.plot, request.common, provenance, [&] { return figure_of(request, report); });
    };
    return result;
}

// An array has no column for a name.
void require_text_of_several(const TrackRequest& request) {
    if (request.common.json || names_joint(request.common.output)) return;
    if (output_format(request.common.output, std::nullopt).name != "csv")
        raise<UsageError>("-o {}: an array is of one joint; select one with --joint, or put {} into the name",
                          request.common.output, joint_mark);
}

ExitCode run_track(const TrackRequest& request, const std::string& command_line) {
    check_track(request);
    hash_where_told(request.common, request.plot);
    return run_joints({request.path, request.log, request.common, &request.plot, "tracks", true},
                      [&](const std::optional<std::string>& joint, const CommonOptions& common) {
                          TrackRequest one = request;
                          one.common = common;
                          if (joint) one.log.joint = joint;
                          one.plot.path = of_joint(request.plot.path, joint);
                          one.gear_options.joint_file = of_joint(request.gear_options.joint_file, joint);
                          const bool several = common.messages != nullptr;
                          if (several) require_text_of_several(request);
                          return track_joint(std::move(one), command_line, several);
                      });
}

std::function<ExitCode()> attach_track(Options& options) {
    const auto request = std::make_shared<TrackRequest>();
    options.argument("LOG", request->path, true, "a log; - is standard input");
    attach_gear(options, request->gear_options);
    options.numbers("--output-orders", request->output_orders, Dimension::none,
                    "lines to track along with them, in cycles per output turn");
    options.numbers("--tones", request->tones_hz, Dimension::frequency,
                    "lines of fixed frequency to keep apart: 50Hz");
    options.choice("--method", request->method, method_names,
                   "least squares over sliding windows, or Vold-Kalman");
    options.number(
        "--window-turns", request->window_turns, Dimension::none,
        "ls: window in motor turns (output turns without a gear ratio); 8 periods of the lowest order, or 2 "
        "beats of the closest",
        true);
    options.number("--window", request->window, Dimension::time, "ls: window in time instead", true);
    options.number("--bandwidth", request->bandwidth, Dimension::frequency,
                   "vold-kalman: -3 dB width of each line's envelope; 1 Hz");
    options.count("--poles", request->poles, 1, 4, "vold-kalman: steepness");
    options.number("--rows-per-second", request->rows_per_second, Dimension::frequency,
                   "vold-kalman: rows of the result; 8 in 1/bandwidth", true);
    options.choice("--amplitude", request->amplitude, amplitude_names,
                   "what amplitudes are; stated in the column names");
    options.choice("--against", request->against, against_names, "rows by time, or gathered by signed speed");
    options.number("--speed-step", request->speed_step, Dimension::speed,
                   "width of a row's speeds; about 24 rows when left out", true);
    attach_plot(options, request->plot, request->common);
    attach_log(options, request->log);
    attach_common(options, request->common, {"a track", ".csv .txt .npy .json", true});
    return [request, &options] { return run_track(*request, options.command_line()); };
}

}  // namespace

const Command commands::track{
    .name = "track",
    .summary = "amplitude and phase of each order against time or speed",
    .description =
        "Writes CSV (.npy by -o's extension): time_s, speed_deg_s, and per line amplitude, phase and "
        "standard error.\nAll lines are fitted at once, so that close and crossing ones are "
        "separated.\nExample: ripplenotch track log.csv --orders 1,2 --gear-ratio 100 --against speed",
    .attach = attach_track,
};

}  // namespace ripplenotch
