// SPDX-License-Identifier: MIT
#include "ripplenotch/model/setup_fault.hpp"

namespace ripplenotch {

std::string_view setup_fault_name(SetupFaultKind kind) {
    switch (kind) {
        case SetupFaultKind::wrong_joint:
            return "wrong-joint";
        case SetupFaultKind::other_motion:
            return "other-motion";
        case SetupFaultKind::motion_sign:
            return "motion-sign";
        case SetupFaultKind::motion_unit:
            return "motion-unit";
        case SetupFaultKind::motor_side_motion:
            return "motor-side-motion";
        case SetupFaultKind::torque_sign:
            return "torque-sign";
        case SetupFaultKind::torque_unit:
            return "torque-unit";
        case SetupFaultKind::motor_side_torque:
            return "motor-side-torque";
        case SetupFaultKind::gravity_direction:
            break;
    }
    return "gravity-direction";
}

}  // namespace ripplenotch
