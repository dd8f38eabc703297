// SPDX-License-Identifier: MIT
// ripplenotch identify: ripple lines and gear ratio from one or many logs of a joint.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "cli/command.hpp"
#include "cli/options/joint_runs.hpp"
#include "cli/talk.hpp"
#include "core/matrices/least_squares.hpp"
#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/chart/figures.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/progress.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/document/results.hpp"
#include "ripplenotch/log/log.hpp"
#include "ripplenotch/verdict/gear_choice.hpp"
#include "ripplenotch/verdict/given_terms.hpp"
#include "ripplenotch/verdict/other_motors.hpp"
#include "ripplenotch/verdict/readings.hpp"

namespace ripplenotch {

namespace {

// An identification as people read it.

std::string range(double from, double to, int digits) {
    const std::string low = fmt::format("{:.{}g}", from, digits), high = fmt::format("{:.{}g}", to, digits);
    return low == high ? low : low + "-" + high;
}

std::string hz_range(const Line& line) {
    if (line.hz) return fmt::format("{:.5g}", *line.hz);
    const auto seen = seen_frequencies(line);
    return seen ? range(seen->lowest_hz, seen->highest_hz, 4) : "-";
}

/// At one speed a line is the one or the other.
std::string_view kind_text(const Line& line) {
    return line.kind == LineKind::unknown ? "order or tone" : line_kind_name(line.kind);
}

// Columns of fixed width, so that the tables of several joints stand below one another.
std::string row(std::size_t kind_width, const std::array<std::string, 9>& cells) {
    constexpr std::array<std::size_t, 9> widths = {0, 5, 13, 13, 10, 8, 6, 12, 0};
    std::string text = fmt::format("{:<{}}", cells[0], kind_width);
    for (std::size_t i = 1; i < cells.size(); ++i) text += fmt::format(" {:>{}}", cells[i], widths[i]);
    return text.substr(0, text.find_last_not_of(' ') + 1) + "\n";
}

// An order of the other spline is no odd number of the ratio's.
std::string order_cell(double order, const GearRatioFit& ratio) {
    const std::string other =
        ratio.value ? order_on_other_spline(Order(order), GearRatio(*ratio.value)) : std::string();
    return other.empty() ? fmt::format("{:.4g}", order) : other;
}

std::string line_row(const Line& line, std::size_t kind_width, const GearRatioFit& ratio) {
    std::string note = " " + line.note;
    if (line.order && ratio.value)
        if (const std::string words = order_in_words(Order(*line.order), GearRatio(*ratio.value));
            words.find("other spline") != std::string::npos)
            note += (line.note.empty() ? "" : ", ") + words;
    return row(kind_width,
               {std::string(kind_text(line)), line.order ? order_cell(*line.order, ratio) : "-",
                line.order_output ? fmt::format("{:.3f}", *line.order_output) : "-", hz_range(line),
                fmt::format("{:.3g}", line.amplitude_nm),
                line.phase_known ? fmt::format("{:.0f}", std::round(line.phase_deg) + 0.0) : "-",
                fmt::format("{:.1f}", line.snr), range(line.speed_from_deg_s, line.speed_to_deg_s, 3), note});
}

// The amplitude by speed and direction.

std::string amplitude_cell(const RippleAtSpeed& at) {
    const RippleEstimate& ripple = at.ripple;
    return ripple.present() ? fmt::format("{:.3g} +/- {:.1g}", ripple.amplitude_nm,
                                          normal_95_errors * ripple.standard_error_nm)
                            : fmt::format("none above {:.2g}", ripple.detectable_nm);
}

std::string speed_cell(const RippleAtSpeed& at) {
    const std::string from = fmt::format("{:.3g}", at.speed_from_deg_s),
                      to = fmt::format("{:.3g}", at.speed_to_deg_s);
    return from == to ? from : from + "-" + to;
}

/// A row per order and range of speed, a column per direction; empty without any.
std::string amplitude_table(const std::vector<RippleAtSpeed>& all, const GearRatioFit& ratio) {
    const auto goes = [&](int direction) {
        return std::any_of(all.begin(), all.end(),
                           [&](const RippleAtSpeed& at) { return at.direction == direction; });
    };
    std::vector<int> directions;
    for (const int direction : {1, -1})
        if (goes(direction)) directions.push_back(direction);
    const auto row = [&](const std::string& order, const std::string& speed, const auto& cell) {
        std::string text = fmt::format("{:>5} {:>12}", order, speed);
        for (const int direction : directions) text += fmt::format(" {:>18}", cell(direction));
        return text.substr(0, text.find_last_not_of(' ') + 1) + "\n";
    };
    if (all.empty()) return "";
    std::string text = "\namplitude by speed and direction, zero to peak, +/- 95 %\n";
    text += row("order", "speed", [](int direction) { return direction < 0 ? "backward" : "forward"; });
    text += row("", "deg/s", [](int) { return "Nm"; });
    for (std::size_t i = 0; i < all.size();) {
        std::size_t end = i + 1;
        while (end < all.size() && all[end].ripple.order == all[i].ripple.order &&
               all[end].speed_from_deg_s == all[i].speed_from_deg_s)
            ++end;
        text += row(order_cell(all[i].ripple.order, ratio), speed_cell(all[i]), [&](int direction) {
            for (std::size_t k = i; k < end; ++k)
                if (all[k].direction == direction) return amplitude_cell(all[k]);
            return std::string("-");
        });
        i = end;
    }
    return text;
}

/// One recording a row, with the line's amplitude or the ratio as it alone tells it.
std::string disagreement_table(const Disagreement& one, const std::vector<std::string>& recordings) {
    const bool ratio = one.about == Disagreement::About::ratio;
    std::string text = "\nthe recordings disagree: ";
    if (!ratio) {
        text += one.order ? fmt::format("order {:g}", *one.order)
                          : fmt::format("output order {:.5g}", *one.order_output);
    }
    text += ratio ? "gear ratio\n" : ", Nm\n";
    for (const Disagreement::Value& value : one.values) {
        const std::string name = value.recording < recordings.size()
                                     ? recordings[value.recording]
                                     : fmt::format("recording {}", value.recording + 1);
        text +=
            fmt::format("{:>10.{}g} +/- {:<8.2g} {}\n", value.value, ratio ? 6 : 3, 2.0 * value.error, name);
    }
    return text;
}

/// The motors of other joints in this torque, where something was found, and the bound of all else.
std::string other_motors_table(const Identification& found) {
    if (found.other_motors.empty()) return "";
    std::vector<std::vector<std::string>> rows = {
        {"motor of", "gear ratio", "order", "amplitude Nm", "+/-", ""}};
    for (const OtherMotorRipple& motor : found.other_motors) {
        for (const OtherMotorRipple::AtOrder& at : motor.orders) {
            const std::string bound = at.detectable_nm
                                          ? fmt::format("none above {:.2g} Nm", *at.detectable_nm)
                                          : "not found, no bound";
            rows.push_back({motor.joint, fmt::format("{:.6g}", motor.gear_ratio.value()), shortest(at.order),
                            at.found ? fmt::format("{:.3g}", at.amplitude_nm) : "-",
                            at.found ? fmt::format("{:.1g}", normal_95_errors * at.standard_error_nm) : "-",
                            at.found ? "" : bound});
        }
    }
    std::string text = "\nmotors of other joints in this torque\n" + text_table(rows, "lrrrrl");
    if (!found.other_motors_not_known.empty())
        text += fmt::format("not looked for, since no gear ratio is known: {}\n",
                            fmt::join(found.other_motors_not_known, ", "));
    for (const OtherMotorRipple& motor : found.other_motors)
        if (!motor.doubt.empty()) text += "note: " + motor.doubt + "\n";
    return text;
}

std::string motor_cell(const Identification& found, const std::string& motor) {
    if (const auto amplitude = motor_amplitude(found, motor)) return fmt::format("{:.3g}", *amplitude);
    double bound = 0.0;
    for (const OtherMotorRipple& other : found.other_motors) {
        if (other.joint != motor) continue;
        if (!other.doubt.empty()) return "?";
        for (const OtherMotorRipple::AtOrder& at : other.orders)
            bound = std::max(bound, at.detectable_nm.value_or(std::numeric_limits<double>::infinity()));
        return std::isfinite(bound) ? fmt::format("<{:.2g}", bound) : "?";
    }
    return "-";
}

/// Which motor is in which torque, the largest amplitude of its orders; of the joints that were looked at.
std::string motor_matrix(const std::vector<Identification>& found) {
    const std::vector<std::string> motors = motors_in_matrix(found);
    if (motors.empty()) return "";
    std::vector<std::vector<std::string>> rows = {{"torque of"}};
    for (const std::string& motor : motors) rows.front().push_back(motor);
    for (const Identification& one : found) {
        std::vector<std::string>& row = rows.emplace_back(1, one.joint);
        for (const std::string& motor : motors) row.push_back(motor_cell(one, motor));
    }
    return "\nripple of each motor (columns) in each torque (rows), Nm\n" +
           text_table(rows, "l" + std::string(motors.size(), 'r'));
}

// Verdict first, then ratio, lines, rivals, what the recordings disagree about, notes. `recordings` are
// their names.
std::string identification_report(const CommonOptions& common, const Identification& found,
                                  const std::vector<std::string>& recordings) {
    std::string text = paragraph(common, (found.joint.empty() ? "" : found.joint + ": ") + found.verdict);
    const GearRatioFit& ratio = found.gear_ratio;
    const bool has_ratio = ratio.value && !ratio.contradicted;
    if (has_ratio) {
        text += fmt::format("\ngear ratio {:.4f}, standard error {:.2g}, 95 % interval {:.4f} to {:.4f}\n",
                            *ratio.value, ratio.standard_error, ratio.ci95_low, ratio.ci95_high);
    }
    if (!found.lines.empty()) {
        std::size_t width = 8;
        for (const Line& line : found.lines) width = std::max(width, kind_text(line).size());
        text +=
            "\n" + row(width, {"kind", "order", "output order", "Hz", "amplitude", "phase", "SNR", "speed"});
        text += row(width, {"", "", "per turn", "", "Nm", "deg", "", "deg/s"});
        for (const Line& line : found.lines) text += line_row(line, width, found.gear_ratio);
    }
    if (ratio.second_comb)
        text += fmt::format("second comb: {:.4f} turns of the wave generator against the other spline\n",
                            *ratio.second_comb);
    text += amplitude_table(found.by_speed, found.gear_ratio);
    if (ratio.candidates.size() > (has_ratio ? 1U : 0U)) {
        text += has_ratio ? "\nrival ratios\n" : "\npossible ratios\n";
        for (const RatioCandidate& one : std::span(ratio.candidates).subspan(has_ratio ? 1 : 0))
            text += fmt::format("{:>10.3f}  probability {:.3f}  {}\n", one.value, one.score, one.reason);
    }
    for (const Disagreement& one : found.disagreements) text += disagreement_table(one, recordings);
    text += other_motors_table(found);
    if (!found.notes.empty()) text += "\n";
    for (const std::string& note : found.notes) text += "note: " + note + "\n";
    return text;
}

constexpr std::size_t fewest_rows_held = most_rows_held / 4;  // of each of many long logs

struct IdentifyRequest {
    CommonOptions common;
    ReadOptions log;
    std::vector<std::string> logs;
    GearOptions gear;  ///< a ratio to check
    std::vector<double> order_hint;
    IdentifyOptions identify;
    ResidualOptions residual;
    std::string other_motors = "yes";
    bool require_conclusive = false;
};

/// All logs of one joint.
struct Joint {
    std::string name;
    std::vector<Log> logs;
};

/// The options with which a joint is spoken of, where it is one of several.
CommonOptions about(const CommonOptions& common, const std::string& joint) {
    CommonOptions of_joint = common;
    of_joint.joint = joint;
    return of_joint;
}

std::vector<Joint> read_all_joints(const IdentifyRequest& request, CommonOptions& common,
                                   Provenance& provenance) {
    std::vector<Joint> joints;
    ReadOptions read = request.log;
    take_joint_of(request.residual, read.joint);
    read.gear_ratio = request.gear.ratio;
    read.takes_motor_units = true;
    bool each = false;  // joint by its name; else all logs are of the one joint, whatever they call it
    // A simulated torque stands row by row against all of its log.
    const std::size_t most_rows = request.residual.any()
                                      ? std::numeric_limits<std::size_t>::max()
                                      : std::max(fewest_rows_held, most_rows_held / request.logs.size());
    const std::vector<DegPerSec> speeds = std::exchange(read.constant_speeds, {});
    if (!speeds.empty() && speeds.size() != request.logs.size())
        raise<UsageError>("--constant-speed: read {} speeds for {} logs; state one for all, or one for each",
                          speeds.size(), request.logs.size());
    for (std::size_t i = 0; i < request.logs.size(); ++i) {
        const std::string& path = request.logs[i];
        if (!speeds.empty()) read.constant_speed = speeds[i];
        std::vector<Log> logs = read_joints_in_part(path, read, most_rows);
        if (i == 0 && logs.size() > 1) {
            each = true;
            common.messages = std::make_shared<JointMessages>();
        }
        if (!each && logs.size() > 1)
            raise<DataError>("{}: read {} joints, and {} has one; select one with --joint", path, logs.size(),
                             request.logs.front());
        say_left_out(request.common, logs.front().layout.left_out);
        provenance.inputs.push_back(
            {path, path == "-" ? "" : sha256_as_read(path), logs.front().recording.rows()});
        for (Log& log : logs) {
            const CommonOptions of_joint = about(common, log.trace.joint);
            say_layout(of_joint, log.layout);
            take_residual(request.residual, read, request.logs.size(), {path, log}, of_joint, provenance);
            say_warnings(of_joint, log.recording.warnings);
            provenance.recordings.push_back({log.recording});
            const std::string name = each ? log.trace.joint : logs.front().trace.joint;
            auto joint = std::find_if(joints.begin(), joints.end(),
                                      [&](const Joint& j) { return !each || j.name == name; });
            if (joint == joints.end()) joint = joints.insert(joints.end(), Joint{name, {}});
            joint->logs.push_back(std::move(log));
        }
    }
    return joints;
}

/// That filters for this joint are designed for: of the log with the most rows.
Hertz controller_rate(const Joint& joint) {
    const auto longest =
        std::max_element(joint.logs.begin(), joint.logs.end(),
                         [](const Log& a, const Log& b) { return a.recording.rows() < b.recording.rows(); });
    return longest->recording.clock.nominal_rate;
}

Identification identified_joint(const Joint& joint, const IdentifyRequest& request) {
    for (const Log& log : joint.logs) {
        if (log.trace.size() < fewest_identify_samples) {
            raise<DataError>("{}: {} samples, at least {} are needed to look for lines; leave this log out",
                             log.layout.source, log.trace.size(), fewest_identify_samples);
        }
    }
    Identification found = identify_readings(joint.logs, request.identify);
    add_amplitudes(found, joint.logs, request.identify.hint);
    found.joint = joint.name;
    const std::string& unit = joint.logs.front().recording.torque_unit;
    found.verdict = in_torque_unit(found.verdict, unit);
    for (std::string& note : found.notes) note = in_torque_unit(note, unit);
    found.sample_rate = controller_rate(joint);
    return found;
}

// What was believed and turned out otherwise is told, and not left to the notes.
void say_other_ratio(const IdentifyRequest& request, const CommonOptions& common,
                     const Identification& found) {
    if (!request.gear.ratio || found.gear_ratio.contradicted) return;  // the verdict says the latter
    const std::string against = against_ratio(found, GearRatio(*request.gear.ratio));
    if (!against.empty()) warn(common, against);
}

void check_identify(IdentifyRequest& request) {
    check_gear(request.gear);
    if (request.gear.ratio) request.identify.hint = GearRatio(*request.gear.ratio);
    for (const double n : request.order_hint) {
        if (n < 1.0 || n > highest_motor_order || n != std::floor(n))
            raise<UsageError>("--order-hint {} is not a whole number from 1 to {}", n, highest_motor_order);
        request.identify.hinted_orders.push_back(static_cast<int>(n));
    }
    const double rate = request.identify.false_alarm;
    if (!(rate > 0.0) || rate > 0.5) raise<UsageError>("--false-alarm {} is not between 0 and 0.5", rate);
}

std::vector<std::string> log_names(const Joint& joint) {
    std::vector<std::string> names;
    for (const Log& log : joint.logs) names.push_back(log.layout.source);
    return names;
}

std::string logs_in_words(const std::vector<std::string>& logs) {
    return logs.size() == 1 ? logs.front() : fmt::format("{} and {} more", logs.front(), logs.size() - 1);
}

// A joint whose logs do not do is left out, and its logs with it; of one joint that is an error.
std::vector<Identification> identified_joints(const IdentifyRequest& request, const CommonOptions& common,
                                              std::vector<Joint>& joints) {
    std::vector<Identification> found;
    std::vector<LeftOutJoint> left_out;
    std::vector<Joint> kept;
    std::exception_ptr first_error;
    const std::size_t all = joints.size();
    // How long one joint takes cannot be told beforehand.
    Progress::current().begin("looking for lines", "joints", all > 1 ? all : 0);
    for (Joint& joint : joints) {
        try {
            found.push_back(identified_joint(joint, request));
            say_other_ratio(request, about(common, joint.name), found.back());
            kept.push_back(std::move(joint));
        } catch (const DataError& error) {
            if (!first_error) first_error = std::current_exception();
            left_out.push_back({joint.name, error.what()});
        }
        if (all > 1) Progress::current().add(1);
    }
    if (common.messages) common.messages->say_all(all);
    if (found.empty() && first_error) std::rethrow_exception(first_error);
    say_left_out(request.common, left_out);
    joints = std::move(kept);
    return found;
}

// The ripple of each joint's motor in the torques of the others. All joints of the logs count, whichever are
// asked for, so that one joint alone gets the answer that it gets among all.
void look_for_other_motors(const IdentifyRequest& request, std::span<const Joint> joints,
                           std::vector<Identification>& found) {
    if (joints.empty() || joints.front().logs.size() != request.logs.size()) return;
    if (request.other_motors == "no") {
        for (std::size_t i = 0; i < joints.size() && joints[i].logs.front().layout.joints.size() > 1; ++i)
            found[i].notes.emplace_back("ripple of the other joints' motors was not looked for");
        return;
    }
    ReadOptions read = request.log;
    read.gear_ratio = request.gear.ratio;
    read.takes_motor_units = true;
    const std::size_t most_rows = std::max(fewest_rows_held, most_rows_held / request.logs.size());
    const std::vector<JointLogs> arm =
        read_arm(request.logs, joints.front().logs.front().layout, read, most_rows);
    if (arm.empty()) return;
    StatedMotors stated;
    if (request.gear.ratio) stated.ratio = GearRatio(*request.gear.ratio);
    std::map<std::string, std::optional<GearAccount>> gears;
    for (std::size_t i = 0; i < joints.size(); ++i) gears[joints[i].name] = gear_of_motor(found[i], stated);
    const auto gear_of = [&](const JointLogs& joint) {
        if (!gears.contains(joint.joint))
            gears[joint.joint] = gear_of_motor(identify_readings(joint.logs, request.identify), stated);
        return gears[joint.joint];
    };
    Progress::current().begin("looking for the ripple of other joints' motors", "joints",
                              joints.size() > 1 ? joints.size() : 0);
    for (std::size_t i = 0; i < joints.size(); ++i) {
        const Identification alone = found[i];
        found[i] =
            identify_among(joints[i].logs, alone, motors_of(arm, joints[i].logs, gear_of), request.identify);
        found[i].sample_rate = alone.sample_rate;
        const std::string& unit = joints[i].logs.front().recording.torque_unit;
        found[i].verdict = in_torque_unit(found[i].verdict, unit);
        for (std::string& note : found[i].notes) note = in_torque_unit(note, unit);
        if (joints.size() > 1) Progress::current().add(1);
    }
}

Answer run_identify(IdentifyRequest& request, const std::string& command_line) {
    check_identify(request);
    Provenance provenance{{}, command_line};
    CommonOptions common = request.common;
    std::vector<Joint> joints = read_all_joints(request, common, provenance);
    std::vector<Identification> found = identified_joints(request, common, joints);
    look_for_other_motors(request, joints, found);
    const bool has_matrix = !motors_in_matrix(found).empty();
    if (found.size() > 1 && !has_matrix && common.plot && !names_joint(*common.plot))
        raise<UsageError>(
            "--plot {}: a picture shows one joint, and the log has {}; select one with --joint, or put {} "
            "into the name",
            *common.plot, joints.size(), joint_mark);
    const std::string logs = logs_in_words(request.logs);
    Answer all;
    for (std::size_t i = 0; i < found.size(); ++i) {
        const auto one = std::make_shared<const Identification>(found[i]);
        all.joints.push_back(
            {.text = in_torque_unit(identification_report(request.common, *one, log_names(joints[i])),
                                    joints[i].logs.front().recording.torque_unit),
             .document = [one, provenance] { return identification_text(*one, provenance); },
             .figure = [one, logs] { return identification_figure(logs, *one); },
             .provenance = provenance,
             .joint = one->joint});
    }
    const bool conclusive =
        std::all_of(found.begin(), found.end(), [](const Identification& one) { return one.conclusive; });
    if (all.joints.size() == 1) all = Answer(std::move(all.joints.front()));
    if (!conclusive && request.require_conclusive) all.code = ExitCode::inconclusive;
    if (all.joints.empty()) return all;
    all.text = joined(all.joints, "\n", &Answer::text) + motor_matrix(found);
    all.provenance = provenance;
    const auto each = std::make_shared<const std::vector<Identification>>(std::move(found));
    all.document = [each, provenance] { return identifications_text(*each, provenance); };
    all.figure = [each, logs] { return motor_matrix_figure(logs, *each); };
    return all;
}

std::function<Answer()> attach_identify(Options& options) {
    const auto request = std::make_shared<IdentifyRequest>();
    options.arguments("LOG", request->logs, true, "logs of one joint; several are fitted together");
    attach_gear(options, request->gear,
                {.ratio = "expected gear ratio, checked against the lines", .orders = "", .joint_file = ""});
    options.numbers("--order-hint", request->order_hint, Dimension::none,
                    "expected motor order of the strongest line, 1 to 16");
    options.number("--false-alarm", request->identify.false_alarm, Dimension::none,
                   "false-alarm probability for noise only: that any line is reported");
    attach_other_motors(options, request->other_motors);
    attach_conclusive(options, request->require_conclusive);
    attach_residual(options, request->residual);
    attach_plot(options, request->common);
    attach_log(options, request->log);
    attach_common(options, request->common, {"what identify found", ".txt .json"});
    return [request, &options] { return run_identify(*request, options.command_line()); };
}

}  // namespace

const Command commands::identify{
    .name = "identify",
    .summary = "ripple lines and the gear ratio, from steady speeds or any motion",
    .description =
        "Reads logs of time, velocity and torque (position helps) and finds the lines in the torque: orders, "
        "which turn\nwith the joint, and fixed tones. Fits f = n * ratio * |v| / 360 to the orders. The "
        "answer may be that there is\nno line, or that these logs do not decide it.\nExample: ripplenotch "
        "identify 60.csv 120.csv 180.csv -o joint.json",
    .attach = attach_identify,
};

}  // namespace ripplenotch
