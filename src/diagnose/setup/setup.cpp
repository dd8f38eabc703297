// SPDX-License-Identifier: MIT
#include "ripplenotch/diagnose/setup.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "diagnose/setup/hypotheses.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

std::optional<MistakenFactor> nearest_factor(double scale, const std::vector<MistakenFactor>& factors,
                                             double tolerance) {
    if (scale == 0.0 || !std::isfinite(scale)) return {};
    const auto distance = [scale](double factor) {
        return scale * factor > 0.0 ? std::abs(portable::log(scale / factor))
                                    : std::numeric_limits<double>::infinity();
    };
    std::optional<MistakenFactor> nearest;
    double least = std::min(distance(1.0), portable::log(tolerance));
    for (const MistakenFactor& one : factors) {
        if (distance(one.factor) >= least) continue;
        least = distance(one.factor);
        nearest = one;
    }
    return nearest;
}

void add_evidence(const BlockEvidence& evidence, SetupFault& fault) {
    const auto sum = [](const std::vector<double>& squares) {
        return std::accumulate(squares.begin(), squares.end(), 0.0);
    };
    const double total = sum(evidence.total);
    fault.explained_before = total > 0.0 ? 1.0 - sum(evidence.before) / total : 0.0;
    fault.explained_after = total > 0.0 ? 1.0 - sum(evidence.after) / total : 0.0;
    fault.blocks = evidence.before.size();
    for (std::size_t b = 0; b < evidence.before.size(); ++b)
        if (evidence.after[b] < evidence.before[b]) ++fault.blocks_improved;
}

bool is_clear(const BlockEvidence& evidence, const SetupLimits& limits) {
    SetupFault fault;
    add_evidence(evidence, fault);
    return 1.0 - fault.explained_before >= limits.least_ratio * (1.0 - fault.explained_after) &&
           fault.explained_after >= limits.least_explained &&
           static_cast<double>(fault.blocks_improved) >=
               limits.least_blocks * static_cast<double>(fault.blocks);
}

std::string joint_text(const std::string& name) { return name.empty() ? "this joint" : "joint " + name; }

const SimulationLag* SetupAnswer::lag() const {
    if (motion_lag && motion_lag->identifiable) return &*motion_lag;
    if (torque_lag && torque_lag->identifiable) return &*torque_lag;
    return nullptr;
}

SetupAnswer suspect_setup(const TraceView& log, const SimulatedMotion& simulation,
                          const SetupContext& context) {
    SetupAnswer answer;
    const bool has_motion = simulation.has_motion() && (log.has_position() || !log.velocity_deg_s.empty());
    if (has_motion) answer.motion_lag = lag_by_motion(log, simulation, context.alignment);
    if (!simulation.torque_nm.empty() && log.size() > 0)
        answer.torque_lag = lag_by_torque(log, simulation, context.gear_ratio, context.alignment);
    if (has_motion) {
        answer.faults = motion_faults(log, simulation, *answer.motion_lag, context);
        const bool void_otherwise =
            std::any_of(answer.faults.begin(), answer.faults.end(), [](const SetupFault& fault) {
                return fault.kind == SetupFaultKind::wrong_joint ||
                       fault.kind == SetupFaultKind::other_motion;
            });
        if (void_otherwise) return answer;
    }
    if (!answer.torque_lag) return answer;
    const bool is_same_motion =
        has_motion && std::abs(answer.motion_lag->correlation) >= context.limits.least_correlation;
    SimulationLag lag = *answer.torque_lag;
    if (answer.motion_lag && answer.motion_lag->identifiable) lag = *answer.motion_lag;
    lag.explained = answer.torque_lag->explained;
    if (!lag.identifiable) lag.delay_s = 0.0;
    const auto more = torque_faults(log, simulation, lag, context, is_same_motion);
    answer.faults.insert(answer.faults.end(), more.begin(), more.end());
    return answer;
}

}  // namespace ripplenotch
