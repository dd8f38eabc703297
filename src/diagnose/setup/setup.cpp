// SPDX-License-Identifier: MIT
// Hypotheses on how log and simulation were put together, each a factor of the simulation's series, another
// joint or another motion, by what a regression at their lag leaves in blocks that were not fitted.

#include "ripplenotch/diagnose/setup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "diagnose/setup/lag.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

using Eigen::Index, Eigen::VectorXd;

namespace {

// A true fault passes each by far: factors lie 10 or more apart, and what a repaired set-up leaves is that of
// an ordinary simulation. Squares held out, before to after, and the share of the variance then explained.
constexpr double least_ratio = 4.0, least_explained = 0.5;
constexpr double least_blocks = 0.9;  // that improve: at a fair coin 1 of 93 for 9 of 10
// About a factor: friction and payload change the torque's scale; a controller follows the motion.
constexpr double torque_tolerance = 1.5, motion_tolerance = 1.1, gravity_tolerance = 1.25;
constexpr double same_motion = 0.9;  // correlation
constexpr double least_size = 0.1;   // of a simulated torque with the measured one, to follow a motion
constexpr double longest_of_sensor_s = 0.03;  // a delay within is an effect of the joint, and searched
constexpr double least_turn_deg = 60.0;       // less is an error of the position's zero or of the mount

// The measured series less the simulated one times a factor.
VectorXd less(const BlockProducts& both, double factor) {
    return both.column(Alignment::measured) - factor * both.column(Alignment::simulated);
}

double scale_of(const BlockProducts& both, Places by) {
    by.insert(by.begin(), Alignment::simulated);
    return both.values(less(both, 0.0), by)[0];
}

// Fills in what a repair explains, with an offset and friction of any size; whether that is clear.
bool proves(const BlockProducts& both, const Places& nuisance, const VectorXd& repaired, SetupFault& fault) {
    const auto before = both.left(less(both, 1.0), nuisance, true),
               after = both.left(repaired, nuisance, true);
    const double total = both.squares(less(both, 0.0), {Alignment::constant}),
                 after_all = both.squares(repaired, nuisance),
                 before_all = both.squares(less(both, 1.0), nuisance);
    double improved = 0.0;
    for (std::size_t b = 0; b < before.size(); ++b) improved += after[b] < before[b] ? 1.0 : 0.0;
    fault.explained_before = 1.0 - before_all / total;
    fault.explained_after = 1.0 - after_all / total;
    // Of a simulation that explains nothing the less is left the smaller it is made.
    const double alone = both.squares(less(both, 0.0), nuisance);
    return before_all >= least_ratio * after_all && (1.0 - least_explained) * alone >= after_all &&
           improved >= least_blocks * static_cast<double>(before.size());
}

// The mistaken factor that is nearest to the scale of a series, with its sign; nothing where 1 is as near.
std::optional<SetupFault> factor_fault(const BlockProducts& both, const Places& nuisance,
                                       std::string_view series, const std::optional<GearRatio>& ratio) {
    using Kind = SetupFaultKind;
    const bool is_torque = series == "torque";
    const double scale = scale_of(both, nuisance), size = portable::log(std::max(std::abs(scale), 1e-300));
    double least = portable::log(is_torque ? torque_tolerance : motion_tolerance);
    if (scale > 0.0) least = std::min(least, std::abs(size));
    SetupFault fault;
    const auto consider = [&](double factor, Kind kind, bool is_simulated, std::string_view what) {
        const double off = std::abs(size - portable::log(factor));
        if (off >= least) return;
        least = off;
        fault = {kind,
                 fmt::format("the {} one {}", is_simulated ? "simulated" : "measured", what),
                 {},
                 std::copysign(factor, scale)};
    };
    if (scale < 0.0) consider(1.0, is_torque ? Kind::torque_sign : Kind::motion_sign, true, "");
    for (const bool is_larger : {true, false}) {
        const auto factor = [&](double of) { return is_larger ? of : 1.0 / of; };
        consider(factor(is_torque ? 1000.0 : degrees_per_radian),
                 is_torque ? Kind::torque_unit : Kind::motion_unit, is_larger != is_torque,
                 is_torque ? "is in mNm" : "is in radians");
        if (ratio && ratio->value() > 2.0)
            consider(factor(ratio->value()), is_torque ? Kind::motor_side_torque : Kind::motor_side_motion,
                     is_larger == is_torque, "is on the motor side of the gear");
    }
    if (fault.factor == 1.0 || !proves(both, nuisance, less(both, fault.factor), fault)) return {};
    const bool is_sign = std::abs(fault.factor) == 1.0;
    fault.statement =
        fmt::format("the {} of the log is {:.4g} times the simulated one: {}{}", series, scale,
                    is_sign ? "" : fault.statement, is_sign || fault.factor > 0.0 ? "" : ", and ");
    return fault;
}

// Position and velocity, where both have them, at the lag of the motions.
void add_motion_faults(const TraceView& log, const SimulatedMotion& simulation, SimulationLag& lag,
                       const SetupContext& context, std::vector<SetupFault>& faults) {
    for (const bool is_position : {true, false}) {
        const std::span<const double> left = is_position ? log.position_deg : log.velocity_deg_s,
                                      right =
                                          is_position ? simulation.position_deg : simulation.velocity_deg_s;
        if (left.empty() || right.empty()) continue;
        const BlockProducts both = Alignment(log.time_s, left, false, simulation, right, false)
                                       .products(lag.delay_s, lag.clock_error.value_or(0.0));
        const Places offset{Alignment::constant};
        const VectorXd rows = both.column(Alignment::constant), difference = less(both, 1.0);
        if (is_position)
            lag.position_difference_deg =
                std::sqrt(both.product(difference, difference) / both.product(rows, rows));
        const double share = 1.0 - both.squares(less(both, scale_of(both, offset)), offset, false) /
                                       both.squares(less(both, 0.0), offset, false);
        auto fault = factor_fault(both, offset, is_position ? "position" : "velocity", context.gear_ratio);
        if (!fault || !(share >= same_motion * same_motion)) continue;
        if (fault->factor < 0.0) fault->statement += "its sign is reversed";
        if (fault->kind == SetupFaultKind::motion_unit)
            fault->option =
                fmt::format("--unit {}={}{}", is_position ? context.position_column : context.velocity_column,
                            std::abs(fault->factor) > 1.0 ? "rad" : "deg", is_position ? "" : "/s");
        faults.push_back(*std::move(fault));
    }
}

// The joint of the log that the simulation is of, where it explains far more of that one than of the one in
// hand. `share_of`: what it explains of a joint.
template <class ShareOf>
std::optional<SetupFault> other_joint(const SetupContext& context, double own, std::string_view series,
                                      ShareOf share_of) {
    std::optional<SetupFault> best;
    for (const LoggedJoint& joint : context.others) {
        const double share = share_of(joint.trace);
        if (share < same_motion * same_motion || 1.0 - own < least_ratio * (1.0 - share)) continue;
        if (best && best->explained_after >= share) continue;
        best = {
            SetupFaultKind::wrong_joint,
            fmt::format(
                "the simulated {} is that of joint {} of the log (it explains {:.1f} % of its variance), "
                "not of {} ({:.1f} %)",
                series, joint.name, 100.0 * share,
                context.joint.empty() ? "this joint" : "joint " + context.joint, 100.0 * std::max(own, 0.0)),
            "--joint " + joint.name,
            1.0,
            own,
            share};
    }
    return best;
}

SetupFault other_motion(double explained, std::string_view what) {
    return {SetupFaultKind::other_motion,
            fmt::format("the simulation is of another motion: at no delay does its {}", what),
            {},
            1.0,
            explained,
            explained};
}

// The two torques at their lag.
struct Torques {
    const Alignment& columns;
    BlockProducts both;
    Places nuisance = columns.friction + columns.loop;  // and an offset

    [[nodiscard]] Places motion() const { return nuisance + columns.inertia + columns.gravity; }
    [[nodiscard]] VectorXd simulated() const { return both.column(Alignment::simulated); }

    // -1 or 1; 0 where a set of blocks has another.
    [[nodiscard]] double sign_of_inertia(const VectorXd& torque) const {
        if (columns.inertia.empty()) return 0.0;
        const auto at = static_cast<Index>(nuisance.size());
        const double inertia = both.values(torque, motion())[at];
        for (std::size_t b = 0; b < BlockProducts::blocks; ++b)
            if (!(both.values(torque, motion(), b)[at] * inertia > 0.0)) return 0.0;
        return std::copysign(1.0, inertia);
    }

    [[nodiscard]] bool friction_drives(double factor) const {
        const VectorXd values = both.values(less(both, factor), nuisance);
        VectorXd friction = VectorXd::Zero(simulated().size());
        for (std::size_t c = 1; c < nuisance.size(); ++c)
            friction[nuisance[c]] = values[static_cast<Index>(c)];
        return both.product(friction, both.column(columns.friction.back())) < 0.0;
    }

    [[nodiscard]] std::optional<SetupFault> factor(const SetupContext& context) const {
        auto fault = factor_fault(both, nuisance, "torque", context.gear_ratio);
        if (!fault) return {};
        fault->option = fmt::format("scale={:.6g}", context.torque_scale * fault->factor);
        if (fault->kind == SetupFaultKind::torque_unit && fault->factor > 0.0 && fault->factor < 1.0)
            fault->option = fmt::format("--unit {}=mNm", context.torque_column);
        if (fault->factor > 0.0) return fault;
        // A reversed torque has an inertia below 0. Where both are above, something else is missing.
        const double measured = sign_of_inertia(less(both, 0.0)),
                     inertias = measured * sign_of_inertia(simulated());
        if (inertias > 0.0) return {};
        fault->statement +=
            measured < 0.0 || friction_drives(fault->factor)
                ? "the sign of the measured torque is reversed (its friction would drive the joint)"
                : "the sign of one of them is reversed";
        if (inertias == 0.0 && fault->kind == SetupFaultKind::torque_sign)
            fault->statement += ", or gravity acts in the other direction";
        return fault;
    }

    // Of the simulated torque's square to that of the measured one.
    [[nodiscard]] double relative_square() const {
        return both.squares(simulated(), nuisance) / both.squares(less(both, 0.0), nuisance);
    }

    // Of the simulated torque, by the motion of the log at its delay.
    [[nodiscard]] double share_of_motion() const {
        return 1.0 - both.squares(simulated(), motion()) / both.squares(simulated(), {Alignment::constant});
    }

    // The simulation's own weight, turned: one angle is fitted, and no size.
    [[nodiscard]] std::optional<SetupFault> turned_gravity() const {
        if (columns.gravity.empty() || share_of_motion() < least_explained) return {};
        const auto at = static_cast<Index>(motion().size()) - 2;
        const VectorXd own = both.values(simulated(), motion()),
                       real = both.values(less(both, 0.0), motion());
        const double size = portable::hypot(own[at], own[at + 1]),
                     real_size = portable::hypot(real[at], real[at + 1]);
        const double turn = portable::atan2(own[at] * real[at + 1] - own[at + 1] * real[at],
                                            own[at] * real[at] + own[at + 1] * real[at + 1]);
        if (!(size > 0.0) || !(real_size > 0.0) || std::abs(turn) * degrees_per_radian < least_turn_deg ||
            std::abs(portable::log(real_size / size)) > portable::log(gravity_tolerance))
            return {};
        const double cosine = portable::cos(turn) - 1.0, sine = portable::sin(turn);
        VectorXd repaired = less(both, 1.0);
        repaired[columns.gravity[0]] -= cosine * own[at] - sine * own[at + 1];
        repaired[columns.gravity[1]] -= sine * own[at] + cosine * own[at + 1];
        SetupFault fault{
            SetupFaultKind::gravity_direction,
            fmt::format("the measured weight, {:.3g} Nm, is the simulated one turned by {:.0f} deg: "
                        "gravity acts in another direction in the simulation, or its position has "
                        "another zero",
                        real_size, turn * degrees_per_radian),
            {}};
        return proves(both, nuisance, repaired, fault) ? std::optional(std::move(fault)) : std::nullopt;
    }
};

// By more than its interval and a time within which the delay is not the simulation's.
bool is_behind(const SimulationLag& lag, double least_s) {
    return lag.identifiable && std::abs(lag.delay_s) > least_s &&
           (lag.delay_95_s.low > 0.0 || lag.delay_95_s.high < 0.0);
}

bool changes(std::span<const double> values) {
    if (values.size() < 8) return false;
    const auto [low, high] = std::ranges::minmax(values);
    return high > low;
}

Alignment torques_of(const TraceView& log, const SimulatedMotion& simulation,
                     std::optional<GearRatio> gear_ratio) {
    return {log.time_s, log.torque_nm, false, simulation, simulation.torque_nm, false, &log, gear_ratio};
}

// Together with a weight and an inertia of the joint, what is left of a simulation that has nothing else may
// have any scale and delay: more columns count where they halve the squares of blocks held out at about the
// same scale.
SimulationLag lag_of_torques(const Alignment& both) {
    Places nuisance = both.friction + both.ripple;
    SimulationLag chosen = both.lag({nuisance});
    for (const Places& added : {both.inertia, both.gravity, both.load + both.loop}) {
        if (added.empty() || !chosen.is_compared) continue;
        nuisance = nuisance + added;
        const SimulationLag lag = both.lag({nuisance});
        const bool is_better =
            lag.left < 0.5 * chosen.left && lag.scale * chosen.scale > 0.0 &&
            std::abs(portable::log(lag.scale / chosen.scale)) <= portable::log(torque_tolerance);
        if (lag.identifiable && (!chosen.identifiable || is_better)) chosen = lag;
    }
    return chosen;
}

}  // namespace

SimulationLag lag_by_torque(const TraceView& log, const SimulatedMotion& simulation,
                            std::optional<GearRatio> gear_ratio) {
    if (!changes(log.torque_nm) || !changes(simulation.torque_nm)) return {};
    return lag_of_torques(torques_of(log, simulation, gear_ratio));
}

SimulationLag lag_by_law(const TraceView& log, const SimulatedMotion& command) {
    if (!changes(log.velocity_deg_s) || !changes(command.torque_nm)) return {};
    Alignment both = torques_of(log, command, {});
    const Places sharp = both.add_sharp_friction(log);
    return both.lag(
        {Places{Alignment::measured} + both.friction + both.inertia + both.gravity + both.loop + sharp,
         true});
}

SimulationLag lag_by_motion(const TraceView& log, const SimulatedMotion& simulation) {
    // The same series of both, if there is one: a velocity of the log may have passed a filter that its
    // position has not.
    const bool both_velocities = !log.velocity_deg_s.empty() && !simulation.velocity_deg_s.empty(),
               both_positions = log.has_position() && !simulation.position_deg.empty(),
               may_be_position = both_positions || !both_velocities,
               by_position = log.has_position() && may_be_position,
               simulated_position = !simulation.position_deg.empty() && may_be_position;
    const std::span<const double> left = by_position ? log.position_deg : log.velocity_deg_s,
                                  right = simulated_position ? simulation.position_deg
                                                             : simulation.velocity_deg_s;
    if (!changes(left) || !changes(right)) return {};
    return Alignment(log.time_s, left, by_position, simulation, right, simulated_position)
        .lag({{Alignment::constant}});
}

const SimulationLag* SetupAnswer::lag() const {
    if (motion_lag && motion_lag->identifiable) return &*motion_lag;
    const SimulationLag* torque = torque_lag && torque_lag->identifiable ? &*torque_lag : nullptr;
    if (!torque_to_motion_lag || torque_to_motion_lag->explained < same_motion) return torque;
    // A torque that the motion of the log explains, at whatever delay, is not late by more than a sensor is.
    const SimulationLag& followed = *torque_to_motion_lag;
    if (!followed.identifiable) return nullptr;
    const auto width_s = [](const SimulationLag& lag) { return lag.delay_95_s.high - lag.delay_95_s.low; };
    const bool is_torque_nearer = torque != nullptr && width_s(*torque) < width_s(followed) &&
                                  std::abs(torque->delay_s - followed.delay_s) <= longest_of_sensor_s;
    return is_torque_nearer ? torque : &followed;
}

SetupAnswer suspect_setup(const TraceView& log, const SimulatedMotion& simulation,
                          const SetupContext& context) {
    SetupAnswer answer;
    std::vector<SetupFault>& faults = answer.faults;
    const SimulationLag by_motion = lag_by_motion(log, simulation);
    const double share = by_motion.correlation * by_motion.correlation;
    if (by_motion.is_compared) {
        answer.motion_lag = by_motion;
        auto other = other_joint(context, share, "motion", [&](const TraceView& joint) {
            const double found = lag_by_motion(joint, simulation).correlation;
            return found * found;
        });
        if (other)
            faults.push_back(*std::move(other));
        else if (by_motion.explained < least_explained)
            faults.push_back(other_motion(by_motion.explained, "velocity explain that of the log"));
        if (!faults.empty()) return answer;
        add_motion_faults(log, simulation, *answer.motion_lag, context, faults);
        if (is_behind(*answer.motion_lag, 0.5 / log.sample_rate.value())) answer.shift = answer.motion_lag;
    }
    if (!changes(log.torque_nm) || !changes(simulation.torque_nm)) return answer;
    const Alignment columns = torques_of(log, simulation, context.gear_ratio);
    const SimulationLag by_torque = lag_of_torques(columns);
    answer.torque_lag = by_torque;
    if (!by_torque.is_compared) return answer;
    const bool is_same_motion = share >= same_motion * same_motion;
    std::optional<SetupFault> fault;
    if (!is_same_motion)
        fault = other_joint(context, by_torque.explained, "torque", [&](const TraceView& joint) {
            const SimulationLag lag = lag_by_torque(joint, simulation, context.gear_ratio);
            const bool is_full =
                std::abs(portable::log(std::max(lag.scale, 1e-9))) <= portable::log(torque_tolerance);
            return is_full ? lag.explained : 0.0;
        });
    // A simulation without motion has had the one that its torque follows. Of a single sine that has no one
    // delay, and then that of the torques counts, unless with the motion of the log far more is left with
    // it.
    const Places motion = columns.friction + columns.inertia + columns.gravity;
    const SimulationLag followed = columns.lag({motion, true});
    const auto left_at = [&](double delay_s) {
        const BlockProducts both = columns.products(delay_s);
        return both.squares(less(both, 0.0), Places{Alignment::simulated} + motion);
    };
    if (!by_motion.is_compared && !fault &&
        (followed.identifiable || left_at(by_torque.delay_s) >= least_ratio * left_at(0.0)))
        answer.torque_to_motion_lag = followed;
    const SimulationLag* lag = answer.lag();
    if (lag != nullptr && !by_motion.identifiable && is_behind(*lag, longest_of_sensor_s))
        answer.shift = *lag;
    const Torques torques{columns, columns.products(lag != nullptr ? lag->delay_s : 0.0)};
    if (!fault) fault = torques.factor(context);
    if (!fault) fault = torques.turned_gravity();
    // A torque of no account may follow nothing.
    if (!fault && !is_same_motion && by_torque.explained < least_explained &&
        followed.explained < least_explained && torques.relative_square() > least_size * least_size)
        fault = other_motion(by_torque.explained,
                             "torque explain the measured one, or the motion of the log explain it");
    if (fault) faults.push_back(*std::move(fault));
    return answer;
}

}  // namespace ripplenotch
