// SPDX-License-Identifier: MIT
#pragma once
// What a column's name says: which quantity, how surely, in which unit, of which joint.

#include <string>
#include <string_view>

#include "ripplenotch/log/layout.hpp"

namespace ripplenotch {

/// The reading of one name. Among candidates for a role the lowest rank is taken; equals are an ambiguity.
struct ColumnName {
    Role role = Role::other;
    int rank = 0;  ///< 0 the thing itself; more: a stand-in (motor current, motor side, filtered, a unit that
                   ///< is not read)
    bool reference = false;   ///< what was wished or modelled, not measured: target, ref, desired, model, cmd
    bool motor_side = false;  ///< named after the motor's shaft
    bool current = false;     ///< motor current standing in for torque
    std::string unit;         ///< as written; empty when the name has none
    bool unit_is_sure = false;  ///< written in brackets, or a unit that is not read ("torque_percent")
    std::string joint;          ///< "j4", "3", "shoulder_pan_joint"; empty when the name has none
};

[[nodiscard]] ColumnName read_column_name(std::string_view name);

/// The same for "j3", "joint3", "J3" and "3"; other names in lower case.
[[nodiscard]] std::string joint_key(std::string_view joint);

}  // namespace ripplenotch
