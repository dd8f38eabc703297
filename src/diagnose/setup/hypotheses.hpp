// SPDX-License-Identifier: MIT
#pragma once
// The tests of suspect_setup on the motions and on the torques.

#include <vector>

#include "ripplenotch/diagnose/setup.hpp"

namespace ripplenotch {

/// Faults from the motions of log and simulation at their lag.
[[nodiscard]] std::vector<SetupFault> motion_faults(const TraceView& log, const SimulatedMotion& simulation,
                                                    const SimulationLag& lag, const SetupContext& context);
/// Faults from the torques; `delay_s` is their lag, or 0 where that is not known. `is_same_motion`: from the
/// motions.
[[nodiscard]] std::vector<SetupFault> torque_faults(const TraceView& log, const SimulatedMotion& simulation,
                                                    const SimulationLag& lag, const SetupContext& context,
                                                    bool is_same_motion);

/// A factor between simulation and log that a mistake makes, with its sign.
struct MistakenFactor {
    double factor;
    SetupFaultKind kind;
};
/// The one within the tolerance of a fitted scale; nothing when 1 is as near or none is.
[[nodiscard]] std::optional<MistakenFactor> nearest_factor(double scale,
                                                           const std::vector<MistakenFactor>& factors,
                                                           double tolerance);

/// Squares before and after, by block, as evidence of a fault.
struct BlockEvidence {
    std::vector<double> total, before, after;
};
void add_evidence(const BlockEvidence& evidence, SetupFault& fault);
[[nodiscard]] bool is_clear(const BlockEvidence& evidence, const SetupLimits& limits);

/// "joint 3", or "this joint" where it has no name.
[[nodiscard]] std::string joint_text(const std::string& name);

}  // namespace ripplenotch
