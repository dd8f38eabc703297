// SPDX-License-Identifier: MIT
#pragma once
// What there is to say of an arm that a diagnosis was given.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "ripplenotch/arm/arm_lag.hpp"
#include "ripplenotch/arm/arm_travel.hpp"
#include "ripplenotch/core/units.hpp"

namespace ripplenotch {

struct ArmAccount {
    std::string source;  ///< "ur10.urdf", "axes zyyzyz"
    std::string rule;    ///< how joints were matched: "by name"
    std::string option;  ///< that would force it
    std::vector<JointTravel> joints;
    std::size_t values_there = 0, values_told = 0;
    bool values_are_stated = false;   ///< by a model; there is no fit then, and nothing below of one
    bool all_joints_at_once = false;  ///< or this joint alone
    bool lengths_are_guessed = false;
    double pull = 0.0;
    Seconds smoothing;
    double gap_before_nm = 0.0;   ///< rms of the torque about its mean
    double gap_nm = 0.0;          ///< rms of what arm and friction beside it leave, on fifths left out
    std::optional<ArmLag> lag;    ///< of the torques of all joints behind their motion
    bool lag_is_applied = false;  ///< known to the model as a delay of that size
    std::vector<std::string> warnings, notes;
};

}  // namespace ripplenotch
