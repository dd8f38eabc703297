// SPDX-License-Identifier: MIT
#pragma once
// Hypotheses on how an arm and a log of its joints were put together, the delay of its torques, and the
// summary of an arm that a diagnosis uses.

#include <optional>
#include <string>
#include <vector>

#include "ripplenotch/arm/arm_fit.hpp"
#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/model/fit.hpp"
#include "ripplenotch/model/setup_fault.hpp"

namespace ripplenotch {

/// Torques whose sign is reversed or whose unit is mNm: with that corrected the joints, which share the
/// links, fit one arm clearly better on held-out fifths of the log; of all signs and their opposites friction
/// decides. Then, with those torques corrected, whether another direction of gravity along an axis of the
/// base fits clearly better; where all that is right, whether two joints are exchanged. `fit`: of these, as
/// fit_arm made it with these options. Takes as long as a fit of the arm with one window for each joint, five
/// directions and each pair of joints. A factor that all torques share cannot be found: heavier links have
/// it.
[[nodiscard]] std::vector<SetupFault> suspect_arm(const Chain& chain, const ArmLog& log, const ArmFit& fit,
                                                  const ArmFitOptions& options = {});

// By how much the torques of an arm are logged later than its motion: one controller has one clock, so that
// this is one number for all joints.

struct JointLag {
    std::size_t joint = 0;  ///< index of the joint in the chain
    double delay_s = 0.0;
    bool contradicts = false;  ///< the common delay, at 95 % over all joints (studentised deleted residual)
};

struct ArmLag {
    double delay_s = 0.0;  ///< below 0: the motion is behind the torque
    Interval delay_95_s;   ///< from the differences between joints, Student's t
    std::vector<JointLag> joints;

    /// Whether the interval excludes 0.
    [[nodiscard]] bool is_there() const { return delay_95_s.low > 0.0 || delay_95_s.high < 0.0; }
    [[nodiscard]] bool contradicted_by(std::size_t joint) const;
};

/// The common delay with the smallest residual on held-out fifths, and that of each joint; joints that
/// contradict it are excluded. `fit`: of this log, as fit_arm made it with these options. Nothing for fewer
/// than two joints, or where the error of no joint has a minimum. Takes as long as three to nine fits with
/// one window.
[[nodiscard]] std::optional<ArmLag> common_lag(const Chain& chain, const ArmLog& log, const ArmFit& fit,
                                               ArmFitOptions options = {});

/// A log whose torques are moved ahead by a delay, with columns of its own.
struct AdvancedLog {
    ArmLog log;
    std::vector<std::vector<double>> torques_nm;

    AdvancedLog(const ArmLog& of, double delay_s);
};

// The summary of an arm that a diagnosis uses.

struct ArmAccount {
    std::string source;  ///< "ur10.urdf", "axes zyyzyz"
    std::string rule;    ///< how joints were matched: "by name"
    std::string option;  ///< option to force it
    std::vector<JointTravel> joints;
    std::size_t values_there = 0, values_told = 0;
    bool values_are_stated = false;   ///< by a model; there is no fit then, and nothing below of one
    bool all_joints_at_once = false;  ///< or this joint alone
    bool lengths_are_guessed = false;
    double pull = 0.0;
    Seconds smoothing;
    double gap_before_nm = 0.0;   ///< rms of the torque about its mean
    double gap_nm = 0.0;          ///< rms residual of arm and friction, on held-out fifths
    std::optional<ArmLag> lag;    ///< lag of the torques of all joints behind their motion
    bool lag_is_applied = false;  ///< known to the model as a delay of that size
    std::string ripple;           ///< that is subtracted first, a sentence; empty: not looked for
    std::vector<std::string> warnings, notes;
};

}  // namespace ripplenotch
