// SPDX-License-Identifier: MIT
#pragma once
// Internal to the log room: which number of a row goes where.

#include <cstddef>
#include <vector>

#include "log/clock/stamp.hpp"
#include "ripplenotch/log/format.hpp"

namespace ripplenotch {

/// Where a row's numbers go: time first, then velocity, torque and position of each joint.
enum RowSlot : std::size_t { time_slot, velocity_slot, torque_slot, position_slot };  // of the first joint
inline constexpr std::size_t slots_a_joint = 3;
constexpr std::size_t slot_of(RowSlot of_first, std::size_t joint) {
    return of_first == time_slot ? time_slot : of_first + slots_a_joint * joint;
}
constexpr std::size_t joint_of(std::size_t slot) { return (slot - velocity_slot) / slots_a_joint; }
constexpr bool is_torque(std::size_t slot) { return slot % slots_a_joint == torque_slot; }
constexpr bool is_position(std::size_t slot) {
    return slot != time_slot && slot % slots_a_joint == position_slot % slots_a_joint;
}
constexpr std::size_t slot_count(std::size_t joints) { return 1 + slots_a_joint * joints; }

/// One wanted column: its place in the row and where its number goes.
struct WantedColumn {
    std::size_t column = 0;
    std::size_t slot = 0;
    bool fraction = false;  ///< nanoseconds, to be added to the seconds of another column
};

/// Where a slot's numbers are kept.
inline std::vector<double>& numbers_of(RowBlock& block, std::size_t slot) {
    if (slot == time_slot) return block.time_s;
    JointRows& joint = block.joints[joint_of(slot)];
    const std::size_t of_first = slot - slots_a_joint * joint_of(slot);
    return of_first == velocity_slot ? joint.velocity_deg_s
           : of_first == torque_slot ? joint.torque_nm
                                     : joint.position_deg;
}

inline constexpr double seconds_per_nanosecond = 1e-9;

/// Those that tell a row's time; none where a rate was stated.
[[nodiscard]] std::vector<WantedColumn> time_columns(const Layout& layout);
/// Every column that is wanted of a layout, with its slot, in the order of the slots.
[[nodiscard]] std::vector<WantedColumn> wanted_columns(const Layout& layout);
[[nodiscard]] StampRule stamp_rule(const Layout& layout, char decimal_mark);
/// What the numbers of each slot are multiplied with to be in the tool's units.
[[nodiscard]] std::vector<double> slot_factors(const Layout& layout, const std::vector<WantedColumn>& wanted);

}  // namespace ripplenotch
