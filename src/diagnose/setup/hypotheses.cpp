// SPDX-License-Identifier: MIT
#include "diagnose/setup/hypotheses.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "diagnose/setup/lag.hpp"
#include "diagnose/setup/setup.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

namespace {

// One series that both have.
struct SharedSeries {
    std::string name, column, radian_unit, degree_unit;
    std::span<const double> log, simulation;
    const SeriesAgreement& agreement;
};

std::vector<MistakenFactor> motion_factors(const std::optional<GearRatio>& gear_ratio) {
    std::vector<MistakenFactor> factors{{-1.0, SetupFaultKind::motion_sign}};
    const auto add = [&](double factor, SetupFaultKind kind) {
        for (const double each : {factor, -factor, 1.0 / factor, -1.0 / factor})
            factors.push_back({each, kind});
    };
    add(degrees_per_radian, SetupFaultKind::motion_unit);
    if (gear_ratio && gear_ratio->value() > 2.0) add(gear_ratio->value(), SetupFaultKind::motor_side_motion);
    return factors;
}

// Squares of the log, less the simulation, and less the simulation times the factor, each about its mean, by
// tenths of what both cover.
BlockEvidence squares_of(const SharedSeries& series, const TraceView& log, const SimulatedMotion& simulation,
                         const SimulationLag& lag, double factor) {
    const SmoothedSeries left(log.time_s, series.log, lag.smoothing_s),
        right(simulation.time_s, series.simulation, lag.smoothing_s);
    std::vector<double> measured, as_it_is, repaired;
    for (const double at_s : window_times({&left}, lag.smoothing_s)) {
        const double other_s = at_s - lag.delay_s;
        if (!right.covers(other_s)) continue;
        measured.push_back(left.mean(at_s));
        as_it_is.push_back(left.mean(at_s) - right.mean(other_s));
        repaired.push_back(left.mean(at_s) - factor * right.mean(other_s));
    }
    const std::vector<double> even(measured.size(), 1.0);
    const auto block = equal_blocks(even, lag.blocks);
    const auto squares = [&](const std::vector<double>& values) {
        return BlockedSquares({even}, values, block).held_out();
    };
    return {squares(measured), squares(as_it_is), squares(repaired)};
}

std::string repair_of(const SharedSeries& series, const MistakenFactor& found) {
    if (found.kind != SetupFaultKind::motion_unit) return {};
    return fmt::format("--unit {}={}", series.column,
                       std::abs(found.factor) > 1.0 ? series.radian_unit : series.degree_unit);
}

std::string statement_of(const SharedSeries& series, const MistakenFactor& found) {
    const bool reversed = found.factor<0.0, larger = std::abs(found.factor)> 1.0;
    std::string text = fmt::format("the {} of the log is {:.4g} times the simulated one: ", series.name,
                                   series.agreement.scale);
    switch (found.kind) {
        case SetupFaultKind::motion_unit:
            text += larger ? "the simulated one is in radians, or that of the log is not in its stated unit"
                           : "the simulated one is in degrees, or that of the log in radians";
            break;
        case SetupFaultKind::motor_side_motion:
            text += larger ? "the log has it on the motor side of the gear, the simulation on the joint side"
                           : "the simulation has it on the motor side of the gear, the log on the joint side";
            break;
        default:
            return text + "its sign is reversed";
    }
    return reversed ? text + ", and its sign is reversed" : text;
}

void add_scale_faults(const TraceView& log, const SimulatedMotion& simulation, const SimulationLag& lag,
                      const SetupContext& context, std::vector<SetupFault>& faults) {
    std::vector<SharedSeries> shared;
    if (lag.position)
        shared.push_back({"position", context.position_column, "rad", "deg", log.position_deg,
                          simulation.position_deg, *lag.position});
    if (lag.velocity)
        shared.push_back({"velocity", context.velocity_column, "rad/s", "deg/s", log.velocity_deg_s,
                          simulation.velocity_deg_s, *lag.velocity});
    for (const SharedSeries& series : shared) {
        if (std::abs(series.agreement.correlation) < context.limits.least_correlation) continue;
        const auto found = nearest_factor(series.agreement.scale, motion_factors(context.gear_ratio),
                                          context.limits.motion_tolerance);
        if (!found) continue;
        const BlockEvidence evidence = squares_of(series, log, simulation, lag, found->factor);
        if (!is_clear(evidence, context.limits)) continue;
        SetupFault fault{found->kind, statement_of(series, *found), repair_of(series, *found), found->factor};
        add_evidence(evidence, fault);
        faults.push_back(std::move(fault));
    }
}

// The joint of the log whose motion is the simulated one, where that is another than the one in hand.
std::optional<SetupFault> other_joint(const SimulatedMotion& simulation, const SimulationLag& lag,
                                      const SetupContext& context) {
    const double own = lag.correlation * lag.correlation;
    std::optional<SetupFault> best;
    for (const LoggedJoint& joint : context.others) {
        const SimulationLag other = lag_by_motion(joint.trace, simulation, context.alignment);
        const double share = other.correlation * other.correlation;
        if (std::abs(other.correlation) < context.limits.least_correlation) continue;
        if (1.0 - own < context.limits.least_ratio * (1.0 - share)) continue;
        if (best && best->explained_after >= other.explained) continue;
        best =
            SetupFault{SetupFaultKind::wrong_joint,
                       fmt::format("the simulation moves as joint {} of the log (correlation of the "
                                   "velocities {:.4f}), not as {} ({:.4f})",
                                   joint.name, other.correlation, joint_text(context.joint), lag.correlation),
                       "--joint " + joint.name};
        best->explained_before = lag.explained;
        best->explained_after = other.explained;
        best->blocks_improved = best->blocks = other.blocks;
    }
    return best;
}

}  // namespace

std::vector<SetupFault> motion_faults(const TraceView& log, const SimulatedMotion& simulation,
                                      const SimulationLag& lag, const SetupContext& context) {
    std::vector<SetupFault> faults;
    if (lag.blocks == 0) return faults;
    if (auto fault = other_joint(simulation, lag, context)) return {*std::move(fault)};
    if (lag.explained < context.limits.least_explained) {
        SetupFault fault{SetupFaultKind::other_motion,
                         fmt::format("the simulation is of another motion: at no delay within {:.2g} s does "
                                     "its velocity explain half of the variance of the measured one "
                                     "(correlation {:.3f})",
                                     search_range_s(log.time_s, context.alignment), lag.correlation),
                         {}};
        fault.explained_before = fault.explained_after = lag.explained;
        fault.blocks = lag.blocks;
        return {fault};
    }
    add_scale_faults(log, simulation, lag, context, faults);
    return faults;
}

namespace {

using SeriesColumns = std::vector<std::vector<double>>;

double sum_of_squares(const std::vector<double>& by_block) {
    return std::accumulate(by_block.begin(), by_block.end(), 0.0);
}

std::vector<MistakenFactor> torque_factors(const std::optional<GearRatio>& gear_ratio) {
    std::vector<MistakenFactor> factors{{-1.0, SetupFaultKind::torque_sign}};
    const auto add = [&](double factor, SetupFaultKind kind) {
        for (const double each : {factor, -factor, 1.0 / factor, -1.0 / factor})
            factors.push_back({each, kind});
    };
    add(1000.0, SetupFaultKind::torque_unit);
    if (gear_ratio && gear_ratio->value() > 2.0) add(gear_ratio->value(), SetupFaultKind::motor_side_torque);
    return factors;
}

// The part of a torque explained by the joint's own motion: an inertia, and a weight.
struct OwnMotion {
    double inertia = 0.0, inertia_error = 0.0, cosine = 0.0, sine = 0.0;
    double explained = 0.0;
    [[nodiscard]] int sign_of_inertia(double quantile) const {
        if (std::abs(inertia) <= quantile * inertia_error) return 0;
        return inertia > 0.0 ? 1 : -1;
    }
};

class TorqueComparison {
  public:
    TorqueComparison(const TraceView& log, const SimulatedMotion& simulation, const SimulationLag& lag,
                     const SetupContext& context)
        : context_(context) {
        const double smoothing_s = lag.smoothing_s;
        const SmoothedSeries left(log.time_s, log.torque_nm, smoothing_s),
            right(simulation.time_s, simulation.torque_nm, smoothing_s);
        std::vector<double> at_s;
        for (const double t : window_times({&left}, smoothing_s)) {
            if (!right.covers(t - lag.delay_s)) continue;
            at_s.push_back(t);
            measured_.push_back(left.mean(t));
            simulated_.push_back(right.mean(t - lag.delay_s));
        }
        const NuisanceColumns columns(log, {}, context.alignment, {at_s, smoothing_s});
        has_position_ = columns.has_position();
        friction_ = columns.of({.friction = true});
        motion_ = columns.of({.friction = true, .inertia = true, .gravity = true});
        inertia_at_ = friction_.size();
        const std::vector<double> even(at_s.size(), 1.0);
        block_ = equal_blocks(even, context.alignment.blocks);
    }

    [[nodiscard]] bool is_long_enough() const {
        return measured_.size() >= context_.alignment.blocks * 4 + 2 * motion_.size();
    }
    [[nodiscard]] bool has_position() const { return has_position_; }
    [[nodiscard]] const std::vector<double>& simulated() const { return simulated_; }
    [[nodiscard]] const std::vector<double>& measured() const { return measured_; }

    // Squares of the measured torque less the simulated one times a factor, and less another torque, that
    // offset and friction leave of blocks held out.
    [[nodiscard]] std::vector<double> squares(double factor, const std::vector<double>& less = {}) const {
        std::vector<double> target = measured_;
        for (std::size_t k = 0; k < target.size(); ++k) {
            target[k] -= factor * simulated_[k];
            if (!less.empty()) target[k] -= less[k];
        }
        return BlockedSquares(friction_, target, block_).held_out();
    }
    // The scale of the simulation that offset and friction leave least with.
    [[nodiscard]] double scale() const {
        SeriesColumns columns{simulated_};
        columns.insert(columns.end(), friction_.begin(), friction_.end());
        return BlockedSquares(columns, measured_, block_).values()[0];
    }
    [[nodiscard]] OwnMotion own_motion(const std::vector<double>& torque) const {
        OwnMotion found;
        const BlockedSquares fit(motion_, torque, block_), mean({motion_.front()}, torque, block_);
        if (inertia_at_ < motion_.size()) {
            const auto at = static_cast<Eigen::Index>(inertia_at_);
            found.inertia = fit.values()[at];
            found.inertia_error = fit.jackknife_error(inertia_at_);
            if (has_position_) {
                found.cosine = fit.values()[at + 1];
                found.sine = fit.values()[at + 2];
            }
        }
        const double all = sum_of_squares(mean.held_out());
        found.explained = all > 0.0 ? 1.0 - sum_of_squares(fit.held_out()) / all : 0.0;
        return found;
    }
    // Whether the fitted offset and friction, with the simulated torque times a factor subtracted, drive the
    // joint, in each set of blocks.
    [[nodiscard]] bool friction_drives(double factor) const {
        if (friction_.size() < 2) return false;
        std::vector<double> target = measured_;
        for (std::size_t k = 0; k < target.size(); ++k) target[k] -= factor * simulated_[k];
        const BlockedSquares fit(friction_, target, block_);
        const auto& velocity = friction_.back();
        return std::all_of(fit.values_without().begin(), fit.values_without().end(), [&](const auto& values) {
            double power = 0.0;
            for (std::size_t c = 1; c < friction_.size(); ++c)
                for (std::size_t k = 0; k < velocity.size(); ++k)
                    power += values[static_cast<Eigen::Index>(c)] * friction_[c][k] * velocity[k];
            return power < 0.0;
        });
    }
    // The weight that the own motion finds, as a torque.
    [[nodiscard]] std::vector<double> weight(double cosine, double sine) const {
        std::vector<double> torque(measured_.size());
        if (!has_position_) return torque;
        for (std::size_t k = 0; k < torque.size(); ++k)
            torque[k] = cosine * motion_[inertia_at_ + 1][k] + sine * motion_[inertia_at_ + 2][k];
        return torque;
    }
    // Squares of the measured torque about its mean.
    [[nodiscard]] std::vector<double> total() const {
        return BlockedSquares({friction_.front()}, measured_, block_).held_out();
    }
    // How much of the torque the simulation explains: deviations together with offset and friction.
    [[nodiscard]] double relative_size() const {
        const auto deviation = [&](const std::vector<double>& torque) {
            return std::sqrt(sum_of_squares(BlockedSquares(friction_, torque, block_).left()));
        };
        const double measured = deviation(measured_);
        return measured > 0.0 ? deviation(simulated_) / measured : 0.0;
    }

  private:
    const SetupContext& context_;
    std::vector<double> measured_, simulated_;
    SeriesColumns friction_, motion_;
    std::vector<std::size_t> block_;
    std::size_t inertia_at_ = 0;
    bool has_position_ = false;
};

std::string factor_statement(const MistakenFactor& found, double scale, bool measured_is_reversed,
                             bool may_be_gravity) {
    std::string text = fmt::format("the measured torque is {:.3g} times the simulated one: ", scale);
    const bool reversed = found.factor<0.0, larger = std::abs(found.factor)> 1.0;
    const std::string sign =
        measured_is_reversed
            ? "the sign of the measured torque is reversed (its friction would drive the joint)"
            : "the sign of one of them is reversed";
    switch (found.kind) {
        case SetupFaultKind::torque_unit:
            text += larger ? "mNm in the log were read as Nm, or the simulated torque is too small by 1000"
                           : "the simulated torque is in mNm and was read as Nm";
            break;
        case SetupFaultKind::motor_side_torque:
            text += larger ? "the simulated torque is on the motor side of the gear"
                           : "the measured torque is on the motor side of the gear";
            break;
        default:
            return text + sign + (may_be_gravity ? ", or gravity acts in the other direction" : "");
    }
    return reversed ? text + ", and " + sign : text;
}

std::string factor_option(const MistakenFactor& found, const SetupContext& context) {
    if (found.kind == SetupFaultKind::torque_unit && found.factor > 0.0 && found.factor < 1.0)
        return fmt::format("--unit {}=mNm", context.torque_column);
    return fmt::format("scale={:.6g}", context.torque_scale * found.factor);
}

std::optional<SetupFault> factor_fault(const TorqueComparison& torques, const SetupContext& context) {
    const double scale = torques.scale();
    const auto found =
        nearest_factor(scale, torque_factors(context.gear_ratio), context.limits.torque_tolerance);
    if (!found) return {};
    const BlockEvidence evidence{torques.total(), torques.squares(1.0), torques.squares(found->factor)};
    if (!is_clear(evidence, context.limits)) return {};
    const double quantile = context.alignment.clock_quantile;
    const int measured = torques.own_motion(torques.measured()).sign_of_inertia(quantile),
              simulated = torques.own_motion(torques.simulated()).sign_of_inertia(quantile);
    // A reversed torque has an inertia below 0. Where both are above, something else is missing.
    if (found->factor < 0.0 && measured * simulated > 0) return {};
    const bool measured_is_reversed =
        found->factor < 0.0 && (measured < 0 || torques.friction_drives(found->factor));
    const bool may_be_gravity = found->factor < 0.0 && measured * simulated == 0;
    SetupFault fault{found->kind, factor_statement(*found, scale, measured_is_reversed, may_be_gravity),
                     factor_option(*found, context), found->factor};
    add_evidence(evidence, fault);
    return fault;
}

std::optional<SetupFault> gravity_fault(const TorqueComparison& torques, const SetupContext& context) {
    if (!torques.has_position()) return {};
    const OwnMotion measured = torques.own_motion(torques.measured()),
                    simulated = torques.own_motion(torques.simulated());
    const double size = portable::hypot(simulated.cosine, simulated.sine),
                 measured_size = portable::hypot(measured.cosine, measured.sine);
    if (!(size > 0.0) || !(measured_size > 0.0) || simulated.explained < context.limits.least_explained)
        return {};
    if (std::abs(portable::log(measured_size / size)) > portable::log(context.limits.gravity_tolerance))
        return {};
    const double along = simulated.cosine * measured.cosine + simulated.sine * measured.sine,
                 across = simulated.cosine * measured.sine - simulated.sine * measured.cosine;
    const double turn_deg = degrees_per_radian * portable::atan2(across, along);
    if (std::abs(turn_deg) < context.limits.least_turn_deg) return {};
    // The simulation's own weight, turned: one angle is fitted, and no size.
    const double cosine = portable::cos_degrees(turn_deg), sine = portable::sin_degrees(turn_deg);
    const auto less = torques.weight((cosine - 1.0) * simulated.cosine - sine * simulated.sine,
                                     sine * simulated.cosine + (cosine - 1.0) * simulated.sine);
    const BlockEvidence evidence{torques.total(), torques.squares(1.0), torques.squares(1.0, less)};
    if (!is_clear(evidence, context.limits)) return {};
    SetupFault fault{SetupFaultKind::gravity_direction,
                     fmt::format("the measured weight, {:.3g} Nm, is the simulated one turned by {:.0f} deg: "
                                 "gravity acts in another direction in the simulation, or its position has "
                                 "another zero",
                                 measured_size, turn_deg),
                     {}};
    add_evidence(evidence, fault);
    return fault;
}

std::optional<SetupFault> other_joint_by_torque(const SimulatedMotion& simulation, const SimulationLag& lag,
                                                const SetupContext& context) {
    std::optional<SetupFault> best;
    for (const LoggedJoint& joint : context.others) {
        if (joint.trace.torque_nm.empty()) continue;
        const SimulationLag other =
            lag_by_torque(joint.trace, simulation, context.gear_ratio, context.alignment);
        const bool is_full = std::abs(portable::log(std::max(other.scale, 1e-9))) <=
                             portable::log(context.limits.torque_tolerance);
        if (other.explained < context.limits.least_correlation || !is_full) continue;
        if (1.0 - lag.explained < context.limits.least_ratio * (1.0 - other.explained)) continue;
        if (best && best->explained_after >= other.explained) continue;
        best = SetupFault{SetupFaultKind::wrong_joint,
                          fmt::format("the simulated torque is that of joint {} of the log (it explains "
                                      "{:.1f} % of its variance on held-out blocks), not of {} ({:.1f} %)",
                                      joint.name, 100.0 * other.explained, joint_text(context.joint),
                                      100.0 * std::max(lag.explained, 0.0)),
                          "--joint " + joint.name};
        best->explained_before = lag.explained;
        best->explained_after = other.explained;
        best->blocks_improved = best->blocks = other.blocks;
    }
    return best;
}

std::optional<SetupFault> other_motion_by_torque(const TorqueComparison& torques, const SimulationLag& lag,
                                                 const SetupContext& context) {
    const SetupLimits& limits = context.limits;
    if (lag.explained >= limits.largest_correlation || torques.relative_size() < limits.least_explained)
        return {};
    // A torque of this very motion may explain nothing: a weight in another direction.
    if (torques.own_motion(torques.simulated()).explained >= limits.least_explained) return {};
    SetupFault fault{SetupFaultKind::other_motion,
                     fmt::format("the simulation is of another motion: at no delay does its torque explain "
                                 "{:.0f} % of the variance of the measured one, nor does the motion of the "
                                 "log explain half of its own",
                                 100.0 * limits.largest_correlation),
                     {}};
    fault.explained_before = fault.explained_after = lag.explained;
    fault.blocks = lag.blocks;
    return fault;
}

}  // namespace

std::vector<SetupFault> torque_faults(const TraceView& log, const SimulatedMotion& simulation,
                                      const SimulationLag& lag, const SetupContext& context,
                                      bool is_same_motion) {
    if (!is_same_motion)
        if (auto fault = other_joint_by_torque(simulation, lag, context)) return {*std::move(fault)};
    const TorqueComparison torques(log, simulation, lag, context);
    if (!torques.is_long_enough()) return {};
    if (auto fault = factor_fault(torques, context)) return {*std::move(fault)};
    if (auto fault = gravity_fault(torques, context)) return {*std::move(fault)};
    if (!is_same_motion)
        if (auto fault = other_motion_by_torque(torques, lag, context)) return {*std::move(fault)};
    return {};
}

}  // namespace ripplenotch
