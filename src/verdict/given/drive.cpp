// SPDX-License-Identifier: MIT
#include "ripplenotch/verdict/drive.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "core/rows/row_facts.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/core/spec.hpp"
#include "verdict/given/simulation_source.hpp"

namespace ripplenotch {
namespace {

constexpr Key drive_keys[] = {
    {.name = "kp", .kind = KeyKind::number, .required = true, .above = 0.0, .help = "Nm/rad"},
    {.name = "kd", .kind = KeyKind::number, .default_text = "0", .at_least = 0.0, .help = "Nm/(rad/s)"},
    {.name = "command", .kind = KeyKind::text, .required = true, .help = "column of the position"},
    {.name = "velocity-command", .kind = KeyKind::text, .help = "column of the velocity"},
    {.name = "delay", .kind = KeyKind::text, .default_text = "0s", .help = "of the command, or fit"},
    {.name = "limit", .kind = KeyKind::number, .dimension = Dimension::torque, .above = 0.0},
};

constexpr std::size_t most_effects_told = 4;  // with more the sentence is longer than 30 words
// The longest that a fit looks for, too.
constexpr double longest_command_delay_s = 1.0;

// A column of the log as that of another role. A command is not held against the velocity of the joint: that
// column is skipped.
Trace read_as(const std::string& role, const std::string& column, ReadOptions reading, const Log& log,
              const std::string& path, std::size_t most_rows) {
    const Layout& layout = log.layout;
    const std::string option = role == "position" ? "--drive pd, command" : "--drive pd, velocity-command";
    for (const Column& one : layout.columns)
        if (one.name == column && one.role != Role::other && one.joint == log.trace.joint)
            raise<UsageError>("{}: '{}' is the {} of the log", option, column, role_name(one.role));
    reading = with_role(std::move(reading), role, column, option);
    if (role == "position" && layout.chosen.velocity && !layout.velocity_from_position) {
        std::erase_if(reading.columns,
                      [](const std::string& entry) { return entry.starts_with("velocity="); });
        reading.columns.push_back(fmt::format("-={}", *layout.chosen.velocity + 1));
    }
    try {
        return (most_rows == all_rows ? read_log(path, reading) : read_log_in_part(path, reading, most_rows))
            .trace;
    } catch (const UsageError& error) {  // of the option that the user did not write
        const std::string_view words = error.what(), columns = "--columns";
        raise<UsageError>(
            "{}{}", option,
            words.starts_with(columns) ? words.substr(columns.size()) : ": " + std::string(words));
    }
}

// The law along one log: what its command asks for, less what position and velocity take back.
class LawAlong {
  public:
    LawAlong(const DriveLaw& law, const Trace& trace, const Trace& command, const Trace* velocity)
        : trace_(trace), limit_nm_(law.limit_nm) {
        const double kp = law.kp_nm_per_rad / degrees_per_radian,
                     kd = law.kd_nm_per_rad_s / degrees_per_radian;
        for (std::size_t k = 0; k < trace.size(); ++k) {
            asked_nm_.push_back(kp * command.position_deg[k] +
                                (velocity != nullptr ? kd * velocity->velocity_deg_s[k] : 0.0));
            taken_nm_.push_back(kp * trace.position_deg[k] + kd * trace.velocity_deg_s[k]);
        }
    }

    // Before the first row of a run its first command is taken.
    [[nodiscard]] std::vector<double> torque_nm(double delay_s) const {
        const TraceView rows = trace_.view();
        std::vector<double> at_s = trace_.time_s;
        double first_s = at_s.front();
        for (std::size_t k = 0; k < at_s.size(); ++k) {
            if (rows.starts_run(k)) first_s = trace_.time_s[k];
            at_s[k] = std::max(at_s[k] - delay_s, first_s);
        }
        std::vector<double> torque = interpolate(trace_.time_s, asked_nm_, at_s);
        for (std::size_t k = 0; k < torque.size(); ++k) torque[k] -= taken_nm_[k];
        return torque;
    }

    [[nodiscard]] bool is_limited(double torque_nm) const {
        return limit_nm_ && std::abs(torque_nm) >= *limit_nm_;
    }

    // Of the rows whose torque is not at its limit, which says nothing of the command: at which they are is
    // known at a delay, so that it is looked for again.
    [[nodiscard]] SimulationLag delay() const {
        SimulationLag found = delay_of(0.0, limit_nm_.has_value());
        for (int again = 0; again < 3 && limit_nm_ && found.is_compared; ++again)
            found = delay_of(found.delay_s, true);
        return found;
    }

  private:
    [[nodiscard]] SimulationLag delay_of(double delay_s, bool leaves_out) const {
        const std::vector<double> torque = leaves_out ? torque_nm(delay_s) : std::vector<double>{};
        std::vector<double> time_s, velocity, position, taken;
        for (std::size_t k = 0; k < trace_.size(); ++k) {
            if (leaves_out && is_limited(torque[k])) continue;
            time_s.push_back(trace_.time_s[k]);
            velocity.push_back(trace_.velocity_deg_s[k]);
            position.push_back(trace_.position_deg[k]);
            taken.push_back(taken_nm_[k]);
        }
        if (time_s.size() < 2) return {};
        return lag_by_law({trace_.sample_rate, time_s, velocity, taken, position},
                          {trace_.time_s, {}, {}, asked_nm_});
    }

    const Trace& trace_;
    std::optional<double> limit_nm_;
    std::vector<double> asked_nm_, taken_nm_;
};

// By which a torque moves the joint behind its law, rms.
class PositionOf {
  public:
    PositionOf(const DriveLaw& law, const Model& model, const TraceView& log)
        : log_(log), kp_nm_per_deg_(law.kp_nm_per_rad / degrees_per_radian) {
        double damping = law.kd_nm_per_rad_s / degrees_per_radian;
        for (const Term& term : model.terms)
            if (term.effect->name == "viscous-friction") damping += term.values.front().value_or(0.0);
        settling_s_ = damping / kp_nm_per_deg_;
    }

    [[nodiscard]] double rms_deg(std::span<const double> torque_nm) const {
        std::vector<double> moved(torque_nm.size());
        for (std::size_t k = 0; k < moved.size(); ++k) {
            const double end = torque_nm[k] / kp_nm_per_deg_;
            const double step_s = k == 0 ? 0.0 : log_.time_s[k] - log_.time_s[k - 1];
            const bool begins = k == 0 || log_.starts_run(k) || settling_s_ <= 0.0;
            moved[k] = begins ? end : end + (moved[k - 1] - end) * portable::exp(-step_s / settling_s_);
        }
        return rms(moved);
    }

  private:
    TraceView log_;
    double kp_nm_per_deg_, settling_s_ = 0.0;
};

}  // namespace

DriveLaw read_drive(std::string_view words) {
    const Spec spec = parse_spec(words);
    if (spec.name != "pd")
        raise<UsageError>(
            "--drive: '{}' is no control law; pd is, as in --drive pd,kp=60,kd=2,command=target_rad",
            spec.name);
    const Settings settings("--drive pd", spec, drive_keys);
    DriveLaw law;
    law.kp_nm_per_rad = settings.number("kp");
    law.kd_nm_per_rad_s = settings.number("kd");
    law.command = settings.text("command");
    if (settings.has("velocity-command")) law.velocity_command = settings.text("velocity-command");
    if (settings.text("delay") == "fit")
        law.delay_s.reset();
    else
        law.delay_s = parse_quantity(settings.text("delay"), Dimension::time, "--drive pd, delay");
    if (law.delay_s && !(*law.delay_s >= 0.0 && *law.delay_s <= longest_command_delay_s))
        raise<UsageError>("--drive pd, delay: {} is not from 0 to {:g} s", settings.text("delay"),
                          longest_command_delay_s);
    if (settings.has("limit")) law.limit_nm = settings.number("limit");
    return law;
}

ReadOptions without_torque(ReadOptions reading) {
    reading.needs_torque = false;
    return reading;
}

DrivenTorque apply_drive(const DriveLaw& law, const ReadOptions& reading, const std::string& path, Log& log,
                         std::size_t most_rows) {
    if (path == "-")
        raise<UsageError>("--drive: standard input cannot be read twice; give the log as a file");
    Trace& trace = log.trace;
    if (!trace.view().has_position())
        raise<DataError>("--drive: {} has no position of the joint for the control law", path);
    ReadOptions options = without_torque(reading);
    if (!trace.joint.empty()) options.joint = trace.joint;
    std::optional<Trace> velocity;
    if (law.velocity_command)
        velocity = read_as("velocity", *law.velocity_command, options, log, path, most_rows);
    const Trace command = read_as("position", law.command, options, log, path, most_rows);
    if (command.position_deg.size() != trace.size() || (velocity && velocity->size() != trace.size()))
        raise<DataError>("--drive: {} of {} rows of {} have a command", command.position_deg.size(),
                         trace.size(), path);
    const LawAlong along(law, trace, command, velocity ? &*velocity : nullptr);
    DrivenTorque found;
    if (law.delay_s) {
        found.delay_s = *law.delay_s;
    } else {
        const SimulationLag lag = along.delay();
        if (!lag.identifiable)
            raise<DataError>(
                "--drive pd, delay=fit: {} does not determine one delay of '{}'; state it, as in delay=4ms, "
                "or "
                "fit it to a faster motion",
                path, law.command);
        found.delay_s = lag.delay_s;
        found.delay_95_s = lag.delay_95_s;
    }
    trace.torque_nm = along.torque_nm(found.delay_s);
    for (double& nm : trace.torque_nm) {
        if (!along.is_limited(nm)) continue;
        nm = std::copysign(*law.limit_nm, nm);
        ++found.limited;
    }
    found.rms_nm = rms(trace.torque_nm);
    return found;
}

DriveAnswer drive_answer(const DriveLaw& law, const DrivenTorque& torque, const Diagnosis& diagnosis,
                         const Motion& motion, const TraceView& log) {
    const PositionOf position(law, diagnosis.model, log);
    DriveAnswer answer{torque,
                       position.rms_deg(diagnosis.residual_before_nm),
                       position.rms_deg(diagnosis.residual_after_nm),
                       {}};
    const std::vector<double> whole = predict_nm(diagnosis.model, motion);
    for (const Finding& finding : diagnosis.rounds) {
        Model without = diagnosis.model;
        const auto term = std::ranges::find_if(without.terms, [&](const Term& one) {
            return one.effect == finding.term.effect && one.values == finding.term.values;
        });
        if (!finding.is_in_model() || finding.status == FindingStatus::correction ||
            term == without.terms.end())
            continue;
        without.terms.erase(term);
        std::vector<double> part = predict_nm(without, motion);
        for (std::size_t k = 0; k < part.size(); ++k) part[k] = whole[k] - part[k];
        answer.position_of_effects_deg.emplace_back(finding.term.effect->name, position.rms_deg(part));
    }
    return answer;
}

std::string drive_words(const DrivenTorque& torque) {
    std::string text = fmt::format("drive: {:.4g} Nm rms by its law; delay of the command {:.4g} ms",
                                   torque.rms_nm, 1e3 * torque.delay_s);
    if (torque.delay_95_s)
        text += fmt::format(" [{:.4g}, {:.4g}]", 1e3 * torque.delay_95_s->low, 1e3 * torque.delay_95_s->high);
    if (torque.limited > 0) text += fmt::format("; {} rows at the limit", torque.limited);
    return text;
}

std::string position_words(const DriveAnswer& answer) {
    std::string text = fmt::format(
        "position: the model's answer to the command is {:.3g} deg rms off the log, {:.3g} with what is "
        "missing",
        answer.position_before_deg, answer.position_after_deg);
    auto effects = answer.position_of_effects_deg;
    std::ranges::stable_sort(effects, std::greater(), [](const auto& effect) { return effect.second; });
    if (effects.size() > most_effects_told) effects.resize(most_effects_told);
    for (std::size_t e = 0; e < effects.size(); ++e)
        text += fmt::format("{}{} {:.3g}", e == 0 ? "; of it " : ", ", effects[e].first, effects[e].second);
    return text;
}

}  // namespace ripplenotch
