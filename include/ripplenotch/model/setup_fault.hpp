// SPDX-License-Identifier: MIT
#pragma once
// A mistake in how a log and a model of it were put together, which no effect of the joint explains.

#include <cstddef>
#include <string>
#include <string_view>

namespace ripplenotch {

enum class SetupFaultKind {
    wrong_joint,        ///< the simulation is of another joint of the log
    other_motion,       ///< the simulation is of another motion
    motion_sign,        ///< position or velocity of the simulation counts the other way
    motion_unit,        ///< rad for deg
    motor_side_motion,  ///< position or velocity before the gear
    torque_sign,        ///< the torque of log or simulation counts the other way
    torque_unit,        ///< mNm for Nm
    motor_side_torque,  ///< the torque before the gear
    gravity_direction,  ///< the weight acts in another direction
};
/// "torque-sign".
[[nodiscard]] constexpr std::string_view setup_fault_name(SetupFaultKind kind) {
    constexpr std::string_view names[] = {"wrong-joint", "other-motion",      "motion-sign",
                                          "motion-unit", "motor-side-motion", "torque-sign",
                                          "torque-unit", "motor-side-torque", "gravity-direction"};
    return names[static_cast<std::size_t>(kind)];
}

struct SetupFault {
    SetupFaultKind kind = SetupFaultKind::other_motion;
    std::string statement;  ///< a sentence without its full stop
    std::string option;     ///< the option to repair it, "scale=-1"; empty where none does
    double factor = 1.0;    ///< factor for the series of the simulation, where that is the fault
    /// Shares of the variance that simulation or arm explain in held-out blocks: as things are, and with the
    /// fault repaired. Below 0 where the residual of the simulation exceeds the torque itself.
    double explained_before = 0.0, explained_after = 0.0;
};

}  // namespace ripplenotch
