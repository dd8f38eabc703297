// SPDX-License-Identifier: MIT
// ripplenotch info: what is in a log, and what can be done with it.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "cli/command.hpp"
#include "cli/options/options.hpp"
#include "cli/talk.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/document/results.hpp"
#include "ripplenotch/log/format.hpp"
#include "ripplenotch/survey/survey.hpp"
#include "ripplenotch/verdict/drive.hpp"

namespace ripplenotch {

namespace {

constexpr std::size_t all_columns_up_to = 12;

std::string figure(double value) { return fmt::format("{:.4g}", value); }

std::string range_text(const std::optional<Range>& range) {
    return range ? fmt::format("{} to {}", figure(range->min), figure(range->max)) : "-";
}

std::string first_sentence(const LogInfo& log) {
    std::string text = log.source + ": " + how_many(log.rows, "row");
    if (log.duration_s && log.clock.nominal_rate.value() > 0.0) {
        text += fmt::format(" over {:.6g} s", *log.duration_s);
        if (log.clock.refusal.empty()) text += fmt::format(" at {:.5g} Hz", log.clock.nominal_rate.value());
    } else {
        text += " without a clock";
    }
    if (log.joints.size() > 1) {
        text += fmt::format(", {} joints", log.joints.size());
    } else if (!log.joints.empty()) {
        const JointInfo& joint = log.joints.front();
        if (!joint.joint.empty()) text += fmt::format(", joint {}", joint.joint);
        if (joint.speed_deg_s) text += fmt::format(", speed {} deg/s", range_text(joint.speed_deg_s));
        if (joint.torque_nm)
            text += fmt::format(", torque {} {}", range_text(joint.torque_nm), joint.recording.torque_unit);
        if (!joint.speed_deg_s && !joint.torque_nm && !joint.position_deg) {
            text += ", no column known as velocity, torque or position";
        } else if (!joint.torque_nm) {
            text += ", no torque";
        }
    }
    return text + ".\n";
}

// Times are written with so many digits that rounding them looks like jitter.
double rounded_jitter(Seconds jitter, Seconds step) {
    return jitter.value() < 1e-5 * step.value() ? 0.0 : jitter.value();
}

std::string clock_text(const LogInfo& log) {
    const ClockFacts& clock = log.clock;
    if (!(clock.nominal_rate.value() > 0.0)) return "no time column and no --sample-rate";
    if (log.layout.stated_rate) return fmt::format("{:.6g} Hz as stated", clock.nominal_rate.value());
    const double nominal = clock.nominal_rate.value(), mean = clock.mean_rate.value();
    std::string text;
    if (std::abs(mean / nominal - 1.0) > rate_worth_a_word)
        text = fmt::format("{:.6g} Hz typical, ", nominal);
    text += fmt::format("{:.5g} Hz mean; step {} ms median, {} to {} ms; jitter {} ms rms; ", mean,
                        figure(1e3 * clock.usual_step.value()), figure(1e3 * clock.shortest_step.value()),
                        figure(1e3 * clock.longest_step.value()),
                        figure(1e3 * rounded_jitter(clock.jitter, clock.usual_step)));
    text += clock.gap_count == 0 ? "no gap" : how_many(clock.gap_count, "gap");
    if (!clock.rate_changes.empty()) {
        text += "; " + how_many(clock.rate_changes.size(), "change of rate", "changes of rate");
    }
    if (clock.repeated_times > 0) text += fmt::format("; {} repeated times", clock.repeated_times);
    return text;
}

std::string clock_factor_text(const std::optional<double>& factor) {
    return factor ? fmt::format("{:.4f}", *factor) : "-";
}

std::string joints_in_log(const LogInfo& log) {
    const bool currents = std::any_of(log.joints.begin(), log.joints.end(), [](const JointInfo& joint) {
        return joint.recording.torque_unit != "Nm";
    });
    TextRows rows = {{"joint", "speed deg/s", currents ? "torque A" : "torque Nm", "turns", "steady", "held",
                      "position/velocity"}};
    for (const JointInfo& joint : log.joints) {
        const auto steady = std::count_if(joint.stretches.begin(), joint.stretches.end(),
                                          [](const SteadyStretch& s) { return !s.rest; });
        rows.push_back({joint.joint.empty() ? "-" : joint.joint, range_text(joint.speed_deg_s),
                        range_text(joint.torque_nm), fmt::format("{:.3g}", joint.turns),
                        std::to_string(steady), std::to_string(joint.recording.held.count),
                        clock_factor_text(joint.clock_factor)});
    }
    return text_table(rows, "lrrrrrr");
}

// With `all`, what is not used is listed too, with the reason.
std::string columns_table(const LogInfo& log, bool all) {
    const auto& columns = log.layout.columns;
    TextRows rows = {{"column", "name", "is", "unit", "joint"}};
    std::size_t others = 0;
    for (std::size_t c = 0; c < columns.size(); ++c) {
        const Column& column = columns[c];
        const bool used = column.role != Role::other;
        if (!used && !all && columns.size() > all_columns_up_to) {
            ++others;
            continue;
        }
        rows.push_back({std::to_string(c + 1), column.name.empty() ? "(no name)" : column.name,
                        all && !used ? "not used: " + column.unused : std::string(role_name(column.role)),
                        used || all ? column.unit + (column.unit_assumed ? " (assumed)" : "") : "",
                        column.joint});
    }
    std::string text = text_table(rows, "rllll");
    if (others > 0) text += fmt::format("and {} other columns\n", others);
    return text;
}

// What is in a container beside the columns that were read.
std::string contents_table(const LogInfo& log) {
    constexpr std::size_t max_listed = 40;
    TextRows rows = {{"in the file", "", "shape", "type", "unit", "Hz"}};
    const auto& contents = log.layout.contents;
    for (std::size_t i = 0; i < std::min(contents.size(), max_listed); ++i) {
        const ContentEntry& entry = contents[i];
        rows.push_back({entry.path, entry.read ? "read" : "", entry.shape, entry.type, entry.unit,
                        entry.rate_hz ? figure(*entry.rate_hz) : ""});
    }
    std::string text = '\n' + text_table(rows, "llllll");
    if (contents.size() > max_listed)
        text += fmt::format("and {} others; --json lists all\n", contents.size() - max_listed);
    return text;
}

// One screen about a log, a sentence first. Wide files list only the columns that mean something.
std::string info_to_text(const LogInfo& log, bool all_columns) {
    std::string text = first_sentence(log);
    // What is assumed, and what it would be otherwise, stands before the figures.
    for (const Assumption& one : log.layout.assumptions) {
        text += fmt::format("Assumed: {} is {}", one.about, one.assumed);
        for (const OtherReading& other : one.others)
            text += fmt::format("; or {} ({})", other.words, other.option);
        text += fmt::format("; {} settles it.\n", one.settle_with);
    }
    text += fmt::format("\nclock     {}\n", clock_text(log));
    if (log.layout.outside) {
        const RowsOutside& outside = *log.layout.outside;
        text += fmt::format("range     {}; left out are {} rows before and {} after\n",
                            range_in_words(outside), outside.before, outside.after);
    }
    text += fmt::format("read as   {}{}\n", log.layout.options,
                        log.joints.size() > 1 ? ", likewise for the other joints" : "");
    if (log.bad_values_held > 0)
        text += fmt::format("held      {} bad values replaced by the value before\n", log.bad_values_held);
    text += '\n' + joints_in_log(log);
    for (const JointInfo& joint : log.joints)
        if (joint.drive)
            text += fmt::format("{}{}\n", joint.joint.empty() ? "" : "joint " + joint.joint + ": ",
                                drive_words(*joint.drive));
    text += '\n' + columns_table(log, all_columns);
    if (!log.layout.contents.empty()) text += contents_table(log);
    text += "\ngood for\n";
    for (const Use& use : log.uses) {
        text += fmt::format("  {:12} {}  {}\n", use.name, use.possible ? "yes" : "no ", use.reason);
    }
    if (!log.layout.inferences.empty() || !log.layout.assumptions.empty()) text += "\nnot stated\n";
    for (const Assumption& one : log.layout.inferences)
        text += fmt::format("  {} is {}: {}\n", one.about, one.assumed, one.reason);
    for (const Assumption& one : log.layout.assumptions)
        text += fmt::format("  {} is taken as {}: {}\n", one.about, one.assumed, one.reason);
    if (!log.warnings.empty()) {
        text += "\nwarnings\n";
        for (const std::string& warning : log.warnings) text += fmt::format("  {}\n", warning);
    }
    return text;
}

struct InfoRequest {
    CommonOptions common;
    ReadOptions log;
    std::vector<std::string> paths;
    std::optional<std::string> drive;
};

// The torque of each joint that its control law makes.
void drive_joints(const InfoRequest& request, const std::string& path, LogInfo& log) {
    for (JointInfo& joint : log.joints) {
        ReadOptions reading = without_torque(request.log);
        if (!joint.joint.empty()) reading.joint = joint.joint;
        Log one = read_log_in_part(path, reading);
        const DriveLaw law = read_drive(with_joint(*request.drive, joint.joint));
        joint.drive = apply_drive(law, reading, path, one, most_rows_held);
    }
}

Answer run_info(const InfoRequest& request, const std::string& command_line) {
    std::vector<LogInfo> logs;
    Provenance provenance{{}, command_line};
    for (const std::string& path : request.paths) {
        logs.push_back(survey_log(path, request.log, most_rows_held, request.drive.has_value()));
        if (request.drive) drive_joints(request, path, logs.back());
        const LogInfo& log = logs.back();
        provenance.inputs.push_back({path, path == "-" ? "" : sha256_as_read(path), log.rows});
        say(request.common, log.source + ": read as if with " + log.layout.options);
    }
    Answer answer{
        joined(logs, "\n", [&](const LogInfo& log) { return info_to_text(log, request.common.verbose); })};
    if (const auto missing = formats_not_built(); !missing.empty())
        answer.text += fmt::format("\nnot in this build: {}\n", fmt::join(missing, ", "));
    answer.document = [logs = std::move(logs), provenance] { return info_to_json(logs, provenance); };
    return answer;
}

std::function<Answer()> attach_info(Options& options) {
    auto request = std::make_shared<InfoRequest>();
    options.arguments("LOG", request->paths, true, "logs to look at; - is standard input");
    attach_drive(options, request->drive);
    attach_log(options, request->log);
    attach_common(options, request->common, {"an inventory", ".txt .json", true});
    return [request, &options] { return run_info(*request, options.command_line()); };
}

}  // namespace

const Command commands::info = {
    .name = "info",
    .summary = "what is in a log and what can be done with it",
    .description =
        "Columns with their roles, units and joints; the measured sample rate, jitter, gaps, held samples; "
        "whether position\n"
        "agrees with integrated velocity; steady stretches. Example: ripplenotch info run7.csv",
    .attach = attach_info,
};

}  // namespace ripplenotch
