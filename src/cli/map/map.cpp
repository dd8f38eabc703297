// SPDX-License-Identifier: MIT
// ripplenotch map: what the ripple of a joint is at every motor angle, speed and direction, from its logs.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/command.hpp"
#include "cli/options/joint_runs.hpp"
#include "cli/talk.hpp"
#include "core/matrices/least_squares.hpp"
#include "ripplenotch/chart/figures.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/core/progress.hpp"
#include "ripplenotch/document/results.hpp"
#include "ripplenotch/filter/map_fit.hpp"
#include "ripplenotch/log/log.hpp"
#include "ripplenotch/verdict/gear_choice.hpp"
#include "ripplenotch/verdict/other_motors.hpp"
#include "ripplenotch/verdict/readings.hpp"

namespace ripplenotch {

namespace {

// A ripple map as people read it.

std::string without_decimals(double value) { return fmt::format("{:.0f}", std::round(value) + 0.0); }

std::string decibels(double from_nm, double to_nm) {
    if (!(from_nm > 0.0 && to_nm > 0.0)) return "-";
    return fmt::format("{:.1f}", 20.0 * portable::log10(from_nm / to_nm) + 0.0);
}

std::string order_cell(double order, const MapFit& fit) {
    return order_text(Order(order), fit.map.gear_ratio);
}

TextRows scores_of(const MapFit& fit) {
    TextRows rows = {{"order", "ripple Nm", "remaining Nm", "dB", "noise limit dB", "predicted %", ""}};
    for (const MapOrderScore& score : fit.scores) {
        rows.push_back({order_cell(score.order, fit), fmt::format("{:.3f}", score.ripple_nm),
                        fmt::format("{:.3f}", score.left_nm), decibels(score.ripple_nm, score.left_nm),
                        decibels(score.ripple_nm, score.noise_nm),
                        without_decimals(100.0 * score.predicted_share),
                        score.in_map ? "" : "follows no map"});
    }
    return rows;
}

TextRows map_values(const MapFit& fit) {
    TextRows rows = {{"order", "at", "cosine Nm", "+/-", "sine Nm", "+/-", "amplitude Nm", "phase deg"}};
    for (std::size_t i = 0; i < fit.map.orders.size(); ++i) {
        for (std::size_t c = 0; c < fit.map.values[i].size(); ++c) {
            const std::complex<double> z = fit.map.values[i][c], error = normal_95_errors * fit.errors[i][c];
            rows.push_back({order_cell(fit.map.orders[i].value(), fit), map_column_words(fit.map.form, c),
                            rounded(z.real(), 3), fmt::format("{:.3f}", error.real()), rounded(z.imag(), 3),
                            fmt::format("{:.3f}", error.imag()),
                            fmt::format("{:.3f}", portable::hypot(z.real(), z.imag())),
                            without_decimals(-portable::arg(z) * degrees_per_radian)});
        }
    }
    return rows;
}

// By motor and order: what is found, or the amplitude that would have been.
TextRows others_of(const MapFit& fit) {
    TextRows rows = {
        {"motor of", "gear ratio", "order", "ripple Nm", "remaining Nm", "dB", "predicted %", ""}};
    for (const MapFit& other : fit.others) {
        for (const MapOrderScore& score : other.scores) {
            const bool bound = std::isfinite(score.detectable_nm) && score.detectable_nm > 0.0;
            rows.push_back({other.map.joint, fmt::format("{:.6g}", other.map.gear_ratio.value()),
                            order_cell(score.order, other), fmt::format("{:.3f}", score.ripple_nm),
                            score.in_map ? fmt::format("{:.3f}", score.left_nm) : "-",
                            score.in_map ? decibels(score.ripple_nm, score.left_nm) : "-",
                            score.in_map ? without_decimals(100.0 * score.predicted_share) : "-",
                            score.in_map ? ""
                            : !bound     ? "not found, no bound"
                                         : fmt::format("none above {:.2g} Nm", score.detectable_nm)});
        }
    }
    return rows;
}

TextRows agreement_of(const MapFit& fit, const std::vector<std::string>& logs) {
    TextRows rows = {{"order", "times as large", "+/-", "deg ahead", "+/-", "", "log"}};
    for (const MapAgreement& one : fit.agreement) {
        rows.push_back({order_cell(one.order, fit), fmt::format("{:.2f}", one.amplitude_ratio),
                        fmt::format("{:.2f}", normal_95_errors * one.amplitude_error),
                        without_decimals(one.phase_deg),
                        without_decimals(std::min(normal_95_errors * one.phase_error_deg, 180.0)),
                        one.agrees ? "" : "disagrees",
                        one.log < logs.size() ? logs[one.log] : fmt::format("log {}", one.log + 1)});
    }
    return rows;
}

// Verdict, what is left of each order on blocks left out, the amplitudes with their 95 % intervals, and what
// the logs say against each other. `logs` are their names.
std::string map_report(const MapFit& fit, const std::vector<std::string>& logs) {
    std::string text = map_verdict(fit) + "\n";
    if (fit.finding != MapFinding::too_little) {
        text += fmt::format("\non {} of 2.5 periods of the lowest order, cross-validated with {} blocks\n",
                            how_many(fit.windows, "window"), fit.blocks);
        text += text_table(scores_of(fit), "rrrrrrl");
    }
    if (fit.finding == MapFinding::mapped) {
        const std::string_view shaft = fit.map.gear_ratio == no_ratio ? "joint" : "motor";
        text += fmt::format(
            "\nripple = cosine cos(order {0} angle) + sine sin(order {0} angle), 95 % intervals\n", shaft);
        text += text_table(map_values(fit), "rlrrrrrr");
        text += fmt::format(
            "\nseen: {:.3g} to {:.3g} deg/s, joint at {:.4g} to {:.4g} deg; beyond, the edge holds\n",
            fit.map.speeds_deg_s.from, fit.map.speeds_deg_s.to, fit.map.positions_deg.from,
            fit.map.positions_deg.to);
    }
    if (!fit.others.empty()) {
        text += "\nmotors of other joints in this torque\n";
        text += text_table(others_of(fit), "lrrrrrrl");
    }
    if (!fit.agreement.empty()) {
        text += "\neach log against a map of the others\n";
        text += text_table(agreement_of(fit, logs), "rrrrrll");
    }
    return text;
}

struct MapRequest : LogRequest {
    std::vector<std::string> logs;
    Degrees zero;
    std::string other_motors = "yes";
    bool require_conclusive = false;
    std::optional<std::string> joint_files = {};  ///< --joint-file where it names one for each joint
};

std::size_t rows_of_each(const MapRequest& request) {
    return std::max(most_rows_held / request.logs.size(), most_rows_held / 4);
}

std::vector<Log> read_map_logs(const MapRequest& request, const GearAccount& gear, Provenance& provenance) {
    const ReadOptions options = read_options(request.log, gear);
    std::vector<Log> logs;
    for (const std::string& path : request.logs) {
        logs.push_back(read_log_in_part(path, options, rows_of_each(request)));
        take_log(request.common, path, logs.back(), provenance);
    }
    return logs;
}

// The gear of another joint: from its file where --joint-file names one each, else identified, or as
// --gear-ratio has it.
std::optional<GearAccount> gear_of_other(const MapRequest& request, const JointLogs& joint,
                                         Provenance& provenance) {
    if (request.joint_files) {
        GearOptions gear = request.gear;
        gear.joint_file = with_joint(*request.joint_files, joint.joint);
        std::error_code failed;
        if (std::filesystem::exists(*gear.joint_file, failed)) {
            try {
                const auto found = GearChoice(gear).of();
                provenance.inputs.push_back(input_record(*gear.joint_file));
                return found;
            } catch (const DataError& error) {
                say(request.common, error.what());  // identify found no gear
            }
        }
    }
    StatedMotors stated;
    for (const StatedOrder& order : request.gear.orders)
        if (!order.per_turn) stated.orders.emplace_back(order.value);
    std::sort(stated.orders.begin(), stated.orders.end());
    if (request.gear.ratio) stated.ratio = GearRatio(*request.gear.ratio);
    return gear_of_motor(identify_readings(joint.logs, {}), stated);
}

Answer map_of_joint(const MapRequest& request, const std::string& command_line) {
    Provenance provenance{{}, command_line};
    const GearChoice choice(request.gear);
    const std::optional<GearAccount> gear = choice.of();
    if (!gear) raise_no_gear("map");
    say(request.common, gear_in_words(*gear));
    const std::vector<Log> logs = read_map_logs(request, *gear, provenance);
    if (choice.joint()) provenance.inputs.push_back(input_record(choice.joint()->path));
    std::vector<JointLogs> arm;
    if (request.other_motors == "yes")
        arm = read_arm(request.logs, logs.front().layout, read_options(request.log, gear),
                       rows_of_each(request));
    const OtherMotors others = motors_of(
        arm, logs, [&](const JointLogs& joint) { return gear_of_other(request, joint, provenance); });
    for (const std::string& joint : others.not_known)
        say(request.common,
            fmt::format(
                "joint {}: its gear ratio is not known, so its motor is not looked for in this torque",
                joint));
    for (const OtherMotor& other : others.motors)
        say(request.common, fmt::format("joint {}: {}", other.joint, gear_in_words(other.gear)));
    MapFit fit = map_readings(logs, *gear, request.zero, others);
    fit.map.joint = logs.front().trace.joint;
    if (const std::string against = against_gear(logs, *gear); !against.empty()) {
        warn(request.common, against);
        fit.conclusive = false;
    }
    for (const std::string& note : fit.notes) say(request.common, note);
    const std::string heading = request.joint ? fit.map.joint + ": " : "";
    const std::string& unit = logs.front().recording.torque_unit;
    const auto found = std::make_shared<const MapFit>(std::move(fit));
    return {
        .text = in_torque_unit(heading + map_report(*found, request.logs), unit),
        .document = [found, provenance, unit] { return in_torque_unit(map_text(*found, provenance), unit); },
        .figure =
            [found, log = request.logs.front()] {
                if (found->map.orders.empty())
                    raise<DataError>("--plot: the map is empty, there is nothing to draw: {}",
                                     map_verdict(*found));
                return map_figure(joint_in_words(log, found->map.joint), *found);
            },
        .provenance = provenance,
        .code = found->conclusive || !request.require_conclusive ? ExitCode::done : ExitCode::inconclusive,
        .joint = found->map.joint};
}

void check_each(const MapRequest& request) {
    if (std::find(request.logs.begin(), request.logs.end(), "-") != request.logs.end())
        raise<UsageError>("--joint all: standard input can be read once only; give a file");
    const auto require_joint = [](std::string_view option, const std::string& path) {
        if (!names_joint(path))
            raise<UsageError>("{} {}: each joint has a map of its own; put {{joint}} into the name", option,
                              path);
    };
    if (request.common.output != "-" || request.common.json) require_joint("-o", request.common.output);
    if (request.common.plot) require_joint("--plot", *request.common.plot);
    if (!request.gear.any()) raise_no_gear("map");
}

// Each joint of the first log by itself, with files of its own; one that has no map keeps none of the others
// back. The exit code is that of the first joint that failed; where none did, what the maps come to.
Answer map_of_each(const MapRequest& request, const std::string& command_line) {
    check_each(request);
    Answer all;
    std::optional<ExitCode> failed;
    const AskedJoints joints = joints_asked_for(request.logs.front(), request.log);
    say_left_out(request.common, joints.left_out);
    const auto messages = std::make_shared<JointMessages>();
    for (const std::string& joint : joints.names) {
        MapRequest one = request;
        CommonOptions common = request.common;
        common.joint = joint;
        common.messages = messages;
        one.take_joint(joint, common);
        try {
            const Answer& map = all.joints.emplace_back(map_of_joint(one, command_line));
            all.text += map.text;
            all.code = std::max(all.code, map.code);
        } catch (const Error& error) {
            talk(fmt::format("{} map: joint {}: {}", tool_name, joint, error.what()));
            if (!failed) failed = error.code();
        }
    }
    messages->say_all(joints.names.size());
    all.code = failed.value_or(all.code);
    return all;
}

Answer run_map(MapRequest& request, const std::string& command_line) {
    if (names_joint(request.gear.joint_file.value_or(""))) request.joint_files = request.gear.joint_file;
    return asks_for_several(request.logs.front(), request.log) ? map_of_each(request, command_line)
                                                               : map_of_joint(request, command_line);
}

std::function<Answer()> attach_map(Options& options) {
    const auto request = std::make_shared<MapRequest>();
    options.arguments("LOG", request->logs, true, "logs of one joint; several make one map and are compared");
    attach_gear(options, request->gear);
    options.number("--zero", request->zero, Dimension::angle,
                   "joint position at which the wave generator's angle counts as 0");
    attach_other_motors(options, request->other_motors);
    attach_conclusive(options, request->require_conclusive);
    attach_plot(options, request->common);
    attach_log(options, request->log);
    attach_common(options, request->common, {"a ripple map", ".txt .json"});
    return [request, &options] { return run_map(*request, options.command_line()); };
}

}  // namespace

const Command commands::map{
    .name = "map",
    .summary = "the ripple by motor angle, speed and direction, for a compensator without delay",
    .description =
        "Reads logs of one joint and fits the cosine and sine amplitude of each order, on both combs of a "
        "harmonic\ndrive, as a function of speed and direction; the form is chosen by cross-validation. The "
        "map\nis empty where no order follows the motor; the amplitude that would have been found is "
        "stated.\n"
        "Example: ripplenotch map log.csv --gear-ratio 100 --orders 1,2 -o map.json",
    .attach = attach_map,
};

}  // namespace ripplenotch
