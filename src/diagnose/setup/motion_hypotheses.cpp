// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "diagnose/setup/blocks.hpp"
#include "diagnose/setup/hypotheses.hpp"
#include "diagnose/setup/shift_fit.hpp"

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
            text += larger
                        ? "the simulated one is in radians, or that of the log is not in what its unit says"
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

}  // namespace ripplenotch
