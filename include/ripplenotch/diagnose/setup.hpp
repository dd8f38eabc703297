// SPDX-License-Identifier: MIT
#pragma once
// Hypotheses on how a simulation and a log were put together, asked before any effect of the joint is.

#include <optional>
#include <string>
#include <vector>

#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/diagnose/alignment.hpp"
#include "ripplenotch/model/setup_fault.hpp"

namespace ripplenotch {

/// Another joint of the same log.
struct LoggedJoint {
    std::string name;
    TraceView trace;
};

/// What a fault has to show. A true fault passes each by far: the factors that are asked for lie 10 or more
/// apart, and a repaired set-up leaves what a simulation usually leaves.
struct SetupLimits {
    double least_ratio = 4.0;        ///< squares held out, before to after: half the residual
    double least_blocks = 0.9;       ///< share of the blocks that improve: at a fair coin 1 of 93 for 9 of 10
    double least_explained = 0.5;    ///< of the variance, once the fault is repaired
    double torque_tolerance = 1.5;   ///< of a fitted scale of the torque about a factor: friction, payload
    double motion_tolerance = 1.1;   ///< the same of a motion, which a controller follows closer
    double least_correlation = 0.9;  ///< of two motions that are the same
    double largest_correlation = 0.1;  ///< explained by a simulation of another motion, of the torque
    double least_turn_deg = 60.0;     ///< of gravity; less is an error of the position's zero or of the mount
    double gravity_tolerance = 1.25;  ///< of its size
};

struct SetupContext {
    std::optional<GearRatio> gear_ratio = {};
    /// Names of the simulation's columns, as options have them; empty: it has no such column.
    std::string torque_column = "simulated", position_column = "position", velocity_column = "velocity";
    double torque_scale = 1.0;  ///< stated, and in the simulation's torque already
    std::string joint;          ///< of the log; may be empty
    std::vector<LoggedJoint> others = {};
    AlignmentOptions alignment = {};
    SetupLimits limits = {};
};

struct SetupAnswer {
    std::vector<SetupFault> faults;  ///< what makes the others void first
    /// Both empty where simulation or log lack what they need.
    std::optional<SimulationLag> motion_lag, torque_lag;

    /// By motion where that is identifiable, else by torque; null: neither is.
    [[nodiscard]] const SimulationLag* lag() const;
};

/// Asks of the motions: another joint, another motion, sign, rad for deg, motor side; of the torques at the
/// lag that was found: another joint, another motion, sign, mNm for Nm, motor side, direction of gravity. A
/// scale between these factors is no fault of the set-up. Torques are compared over the window of the
/// alignment beside an offset and friction of any size. Of 150 simulated logs with random effects, payloads,
/// lags and tracking errors that the simulation lacks none has a fault (the study in
/// tests/diagnose/setup_test.cpp): below 2 % at 95 % confidence.
[[nodiscard]] SetupAnswer suspect_setup(const TraceView& log, const SimulatedMotion& simulation,
                                        const SetupContext& context);

}  // namespace ripplenotch
