// SPDX-License-Identifier: MIT
#include "cli/spectrum/spectrum.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "cli/options/joint_runs.hpp"
#include "cli/talk.hpp"
#include "ripplenotch/analysis/sweeps.hpp"
#include "ripplenotch/analysis/track_report.hpp"
#include "ripplenotch/chart/figures.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/document/spectrum_json.hpp"
#include "ripplenotch/verdict/readings.hpp"

namespace ripplenotch {

namespace {

// What is said of rows that it could not measure.

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
            "{} rows where lines cannot be distinguished from each other or from the trend are left out",
            tracks.rows_not_separable));
    }
    if (tracks.rows_folded > 0) {
        warnings.push_back(
            fmt::format("in {} rows a line lies above half the sample rate: its amplitude is what a low-pass "
                        "before the sampling left of it",
                        tracks.rows_folded));
    }
    return warnings;
}

// Why no row at all could be measured.
std::string why_nothing_tracked(const TrackReport& report) {
    const std::string window = report.window ? shortest(report.window->value()) + " s"
                                             : shortest(report.window_turns.value_or(0.0)) + " turns";
    return fmt::format("the joint nowhere moves in one direction for a window of {}, or for half of one",
                       window);
}

constexpr std::array<std::string_view, 2> against_names = {"time", "speed"};

/// The gear that was chosen; empty where other lines alone are tracked.
std::optional<GearAccount> read_gear(const TrackRequest& request, Provenance& provenance) {
    const GearChoice choice(request.gear);
    if (choice.joint()) provenance.inputs.push_back(input_record(choice.joint()->path));
    std::optional<GearAccount> gear = choice.of();
    const bool orders_stated = !request.gear.orders.empty() || request.gear.joint_file;
    const bool other_lines = !request.output_orders.empty() || !request.tones_hz.empty();
    // Whoever lists other lines and no orders asks for those lines alone.
    if (gear && other_lines && !orders_stated) gear = GearAccount{gear->ratio, {}, {}, {}, "--gear-ratio"};
    if (gear) say(request.common, gear_in_words(*gear));
    if (!gear && !other_lines) {
        raise<UsageError>(
            "nothing to track; give --gear-ratio, for example 100, --orders 200/turn, --joint-file "
            "joint.json, --output-orders, or --tones");
    }
    return gear;
}

/// The signal that is tracked, with the angles and speeds that it borrows.
struct Prepared {
    OutputAngle angle;
    std::vector<double> motor_turns, speed;
    TrackedSignal signal;
    std::vector<TrackLabel> labels;
    std::vector<double> reference_orders;  ///< of the lines that turn, per turn of the reference shaft
};

using Gear = std::optional<GearAccount>;

std::unique_ptr<Prepared> prepare(const TrackRequest& request, const Gear& gear, const TraceView& trace) {
    auto p = std::make_unique<Prepared>();
    p->angle = output_angle(trace);
    p->speed = smoothed_speed(trace);
    const double ratio = gear ? gear->ratio.value() : 1.0;
    p->motor_turns = p->angle.turns;
    for (double& turns : p->motor_turns) turns *= ratio;
    p->signal = {trace.sample_rate, trace.time_s, trace.torque_nm,  p->speed,
                 p->motor_turns,    {},           trace.run_starts, GearRatio(ratio)};
    const auto add = [&](TrackLabel::Kind kind, double value, std::span<const double> turns) {
        p->labels.push_back({kind, value});
        p->signal.lines.push_back({value, turns});
    };
    for (const Order order : gear ? gear->orders : std::vector<Order>{}) {
        add(gear->per_turn ? TrackLabel::Kind::order_output : TrackLabel::Kind::order, order.value(),
            p->motor_turns);
        p->reference_orders.push_back(order.value());
    }
    for (const double order : request.output_orders) {
        add(TrackLabel::Kind::order_output, order, p->angle.turns);
        p->reference_orders.push_back(order / ratio);
    }
    for (const double hz : request.tones_hz) add(TrackLabel::Kind::tone, hz, trace.time_s);
    return p;
}

void track_lines(const TrackRequest& request, const Prepared& prepared, TrackReport& report) {
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

// As text, for the rows of several joints below one another.
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
    const std::string source = joint_in_words(request.path, report.joint);
    Figure figure = report.by_speed ? track_figure(source, *report.by_speed, names)
                                    : track_figure(source, report.tracks, names);
    figure.sentence = report.doubt + track_verdict(report);
    return figure;
}

/// All lines that turn are estimated together, as they are tracked.
std::vector<std::optional<RippleEstimate>> ripple_of_lines(const Gear& gear, const Prepared& prepared,
                                                           const TraceView& trace) {
    const GearRatio ratio = gear ? gear->ratio : GearRatio(1.0);
    std::vector<Order> orders;
    for (const double order : prepared.reference_orders) orders.emplace_back(order);
    std::vector<std::optional<RippleEstimate>> found;
    for (RippleEstimate& one : estimate_ripple({&trace, 1}, ratio, orders))
        found.emplace_back(std::move(one));
    found.resize(prepared.labels.size());  // tones come last
    return found;
}

/// A reading under which something turns with the shaft is confirmed by that, unless another one has it, too.
std::string unit_doubt(const TrackRequest& request, const Gear& gear, const Prepared& prepared,
                       const Log& log) {
    const auto shows = [&](const Prepared& of, const TraceView& trace) {
        const auto found = ripple_of_lines(gear, of, trace);
        return std::any_of(found.begin(), found.end(), [](const auto& one) { return one && one->present(); });
    };
    if (prepared.reference_orders.empty()) return "";
    const bool confirmed = shows(prepared, log.trace.view());
    const std::string doubt = reading_doubt({&log, 1}, [&](const OtherReading& reading) {
        const Trace trace = read_otherwise(log.trace, reading);
        return !confirmed ||
               (!reading.changes_side && shows(*prepare(request, gear, trace.view()), trace.view()));
    });
    if (doubt.empty()) return "";
    warn(request.common, doubt);
    return fmt::format("Cannot tell: {}. ", doubt);
}

TrackReport track_report_of(const TrackRequest& request, const Gear& gear, const Prepared& prepared,
                            const Trace& trace) {
    TrackReport report;
    report.joint = trace.joint;
    report.ripple = ripple_of_lines(gear, prepared, trace.view());
    report.gear = gear;
    report.angle_from_position = prepared.angle.absolute;
    report.labels = prepared.labels;
    try {
        track_lines(request, prepared, report);
    } catch (const DataError& error) {  // the library knows no file
        raise<DataError>("{}: {}", request.path, error.what());
    }
    return report;
}

Answer track_joint(const TrackRequest& request, const std::string& command_line, bool one_of_several) {
    Provenance provenance{{}, command_line};
    const Gear gear = read_gear(request, provenance);
    const Log log = read_log_in_part(request.path, read_options(request.log, gear));
    take_log(request.common, request.path, log, provenance);

    const auto prepared = prepare(request, gear, log.trace.view());
    TrackReport report = track_report_of(request, gear, *prepared, log.trace);
    say_warnings(request.common, track_warnings(report));
    report.doubt = unit_doubt(request, gear, *prepared, log);
    if (report.tracks.time_s.empty())
        raise<DataError>("{}: no row could be measured: {}", request.path, why_nothing_tracked(report));
    if (request.against == "speed")
        report.by_speed = gather_by_speed(report.tracks, request.speed_step.value_or(DegPerSec(0.0)));
    const std::string unit = log.recording.torque_unit;
    Answer answer{.kind = Answer::Text::rows, .provenance = provenance};
    if (!request.common.json) {
        say(request.common, in_torque_unit(report.doubt + track_verdict(report), unit));
        if (one_of_several) answer.text = csv_of(report);
        answer.columns = columns_of(report);
        answer.format = &output_format(request.common.output, std::nullopt);
    }
    const auto found = std::make_shared<const TrackReport>(std::move(report));
    answer.document = [=] { return in_torque_unit(track_text(*found, provenance), unit); };
    answer.figure = [=] { return figure_of(request, *found); };
    return answer;
}

// An array has no column for a name.
void require_text_of_several(const TrackRequest& request) {
    if (request.common.json || names_joint(request.common.output)) return;
    if (output_format(request.common.output, std::nullopt).name != "csv")
        raise<UsageError>("-o {}: an array is of one joint; select one with --joint, or put {} into the name",
                          request.common.output, joint_mark);
}

}  // namespace

Answer run_track(const TrackRequest& request, const std::string& command_line) {
    return ask_joints(request, "tracks", [&](const TrackRequest& one) {
        const bool several = one.common.messages != nullptr;
        if (several) require_text_of_several(request);
        return track_joint(one, command_line, several);
    });
}

void check_track(const TrackRequest& request) {
    const bool any = !request.output_orders.empty() || !request.tones_hz.empty() || request.window_turns ||
                     request.window || request.against != "time";
    if (any && !request.wanted)
        raise<UsageError>(
            "--output-orders, --tones, --window, --window-turns and --against belong to --track");
    if (request.window_turns && request.window)
        raise<UsageError>("--window and --window-turns exclude each other");
    if (request.wanted && request.speed_step && request.against != "speed")
        raise<UsageError>("--speed-step belongs to --against speed");
}

void attach_track(Options& options, TrackRequest& request) {
    options.flag("--track", request.wanted,
                 "amplitude and phase of each order against time or speed instead, all lines fitted at once");
    options.numbers("--output-orders", request.output_orders, Dimension::none,
                    "--track: lines to track along with them, in cycles per output turn");
    options.numbers("--tones", request.tones_hz, Dimension::frequency,
                    "--track: lines of fixed frequency to keep apart: 50Hz");
    options.number("--window-turns", request.window_turns, Dimension::none,
                   "--track: window in motor turns (output turns without a gear ratio); 8 periods of the "
                   "lowest order, or 2 beats of the closest",
                   true);
    options.number("--window", request.window, Dimension::time, "--track: window in time instead", true);
    options.choice("--against", request.against, against_names,
                   "--track: rows by time, or gathered by signed speed");
}

}  // namespace ripplenotch
