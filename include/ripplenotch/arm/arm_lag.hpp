// SPDX-License-Identifier: MIT
#pragma once
// By how much the torques of an arm are logged later than its motion: one controller has one clock, so that
// this is one number for all joints.

#include <optional>
#include <vector>

#include "ripplenotch/arm/arm_fit.hpp"
#include "ripplenotch/model/fit.hpp"

namespace ripplenotch {

struct JointLag {
    std::size_t joint = 0;  ///< of the chain
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

/// The common delay that leaves least on held-out fifths, and that of each joint; joints that contradict it
/// do not count in it. `fit`: of this log, as fit_arm made it with these options. Nothing for fewer than two
/// joints, or where the error of no joint has a minimum. Takes as long as three to nine fits with one window.
[[nodiscard]] std::optional<ArmLag> common_lag(const Chain& chain, const ArmLog& log, const ArmFit& fit,
                                               ArmFitOptions options = {});

/// A log whose torques are moved ahead by a delay, with columns of its own.
struct AdvancedLog {
    ArmLog log;
    std::vector<std::vector<double>> torques_nm;

    AdvancedLog(const ArmLog& of, double delay_s);
};

}  // namespace ripplenotch
