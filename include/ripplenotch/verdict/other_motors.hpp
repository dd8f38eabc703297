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

/// The joints of the logs at `paths` that have a position in each of them; none where `layout`, that of the
/// first log, has fewer than two joints.
[[nodiscard]] std::vector<JointLogs> read_arm(std::span<const std::string> paths, const Layout& layout,
                                              const ReadOptions& options, std::size_t most_rows);

/// What is stated of the gears of other joints.
struct StatedMotors {
    /// Of the joint that is looked at: an arm's joints often have the same. It counts where nothing else is
    /// known of a joint, and where what identify finds in its own torque agrees.
    std::optional<GearRatio> ratio = std::nullopt;
    std::vector<Order> orders = {};  ///< that were asked for; empty: those identified, or default_orders()
};

/// The gear of a joint's motor as identify found it in the joint's own torque, or as it is stated.
[[nodiscard]] std::optional<GearAccount> gear_of_motor(const Identification& found,
                                                       const StatedMotors& stated);

/// Empty where it is not known.
using GearOfJoint = std::function<std::optional<GearAccount>(const JointLogs& joint)>;

struct OtherMotors {
    std::vector<OtherMotor> motors;      ///< views of the logs of the joints
    std::vector<std::string> not_known;  ///< joints whose gear ratio is not known
    std::size_t looked_at = 0;           ///< all of these

    /// Of a torque and another motor that the logs have.
    [[nodiscard]] std::size_t pairs() const { return looked_at * (looked_at + 1); }
};

/// The motors of these joints but the one that `own` is of, whose rows theirs have to be. They are views of
/// `arm`.
[[nodiscard]] OtherMotors motors_of(std::span<const JointLogs> arm, std::span<const Log> own,
                                    const GearOfJoint& gear_of);

}  // namespace ripplenotch
