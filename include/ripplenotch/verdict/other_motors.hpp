// SPDX-License-Identifier: MIT
#pragma once
// The motors of a log's other joints, whose ripple may be in the torque of the one that is looked at.

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/filter/map_fit.hpp"
#include "ripplenotch/log/log.hpp"

namespace ripplenotch {

/// A joint by its name, with one log for each that is read.
struct JointLogs {
    std::string joint;
    std::vector<Log> logs;
};

/// The other joints of the logs at `paths`, of which `own` was read by these options, that have a position of
/// their own at the same rows. None for logs of one joint.
[[nodiscard]] std::vector<JointLogs> read_other_joints(std::span<const std::string> paths,
                                                       std::span<const Log> own, const ReadOptions& options,
                                                       std::size_t most_rows);

/// What is known of the gear of another joint.
struct StatedMotors {
    /// Of a joint by its name: from a file of that joint.
    std::function<std::optional<GearAccount>(const std::string& joint)> of_file = {};
    /// Of the joint that is looked at: an arm's joints often have the same. It counts where nothing else is
    /// known of a joint, and where what identify finds in its own torque agrees.
    std::optional<GearRatio> ratio = std::nullopt;
    std::vector<Order> orders = {};  ///< that were asked for; empty: those identified, or default_orders()
};

struct OtherMotors {
    std::vector<OtherMotor> motors;      ///< views of the logs of the joints
    std::vector<std::string> not_known;  ///< joints whose gear ratio nobody knows
    std::size_t pairs = 1;               ///< of a torque and another motor that the log has
};

/// The gear of a joint's motor as identify found it in the joint's own torque, or as it is stated.
[[nodiscard]] std::optional<GearAccount> gear_of_motor(const Identification& found,
                                                       const StatedMotors& stated);

/// The motors of these joints; a gear that nobody states is identified from the joint's own torque.
[[nodiscard]] OtherMotors motors_of(std::span<const JointLogs> joints, const StatedMotors& stated);

/// The same for gears that are known, empty where they are not, in the order of the joints.
[[nodiscard]] OtherMotors motors_of(std::span<const JointLogs> joints,
                                    std::span<const std::optional<GearAccount>> gears);

}  // namespace ripplenotch
