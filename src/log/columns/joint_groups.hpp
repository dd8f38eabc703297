// SPDX-License-Identifier: MIT
#pragma once
// A part of decide_layout: which columns belong to one joint, and which of them is its velocity, its torque,
// its position.

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "log/columns/column_name.hpp"
#include "log/columns/decide_layout.hpp"

namespace ripplenotch::layout_detail {

inline constexpr std::array motion_roles = {Role::velocity, Role::torque, Role::position};

/// All columns that could be one joint's velocity, torque or position.
struct JointGroup {
    std::string key, name;
    std::map<Role, std::vector<std::size_t>> candidates;
    [[nodiscard]] bool has(Role role) const { return candidates.count(role) > 0; }
};

/// What is known of a file's columns.
struct KnownColumns {
    const std::string& source;  ///< for messages
    const ColumnFacts& facts;
    const Forced& forced;
    const std::vector<ColumnName>& names;  ///< what each column's name says
};

/// The joints of a file, in its order; those with a torque and a motion alone where there are any, or with a
/// motion where that is enough. Columns that are named after different things are one joint's unless a joint
/// was asked for by its name.
[[nodiscard]] std::vector<JointGroup> group_joints(const KnownColumns& known, bool joint_asked,
                                                   bool needs_torque = true);

/// The one column for a role, empty when there is none. Throws DataError where several are equally good.
[[nodiscard]] std::optional<std::size_t> choose_column(const KnownColumns& known, const JointGroup& group,
                                                       Role role, std::vector<LogWarning>& warnings);

}  // namespace ripplenotch::layout_detail
