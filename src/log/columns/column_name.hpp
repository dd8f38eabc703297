// SPDX-License-Identifier: MIT
#pragma once
// What a column's name says: which quantity, how surely, in which unit, of which joint.

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "log/columns/decide_layout.hpp"
#include "ripplenotch/log/layout.hpp"

namespace ripplenotch {

struct Convention;

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
    /// What a letter such as v, w or T stands for as a whole name, where the other names allow it: then
    /// `role` is that one, too, unless another reading is as good.
    Role symbol = Role::other;
    bool sensor = false;  ///< named as measured by a sensor
    std::string
        suffix;        ///< a last word that is none of the table: a joint's name, or a unit that is not known
    std::string bare;  ///< the name without its unit
    std::vector<const Convention*> conventions;  ///< that the name follows, in the order of the table
    /// The first convention that the name follows as a column of this role; null when there is none.
    [[nodiscard]] const Convention* convention(Role as) const;
};

[[nodiscard]] ColumnName read_column_name(std::string_view name, bool linear_axis = false);

/// Whether all words of a text are of the table of names.
[[nodiscard]] bool is_known_word(std::string_view text);

/// All names of a log, with what only the other names decide: whether T is a time or a torque.
/// `units` by column, from a row of them; may be empty.
[[nodiscard]] std::vector<ColumnName> read_column_names(const std::vector<std::string>& names,
                                                        const std::vector<std::string>& units);

/// The same for "j3", "joint3", "J3" and "3"; other names in lower case.
[[nodiscard]] std::string joint_key(std::string_view joint);

// A part of decide_layout: which columns belong to one joint, and which of them is its velocity, its torque,
// its position.

inline constexpr std::array motion_roles = {Role::velocity, Role::torque, Role::position};

/// All columns that could be one joint's velocity, torque or position.
struct JointGroup {
    std::string key, name;
    std::array<std::vector<std::size_t>, 4> candidates = {};  ///< by role
    [[nodiscard]] std::vector<std::size_t>& of(Role role) {
        return candidates[static_cast<std::size_t>(role)];
    }
    [[nodiscard]] const std::vector<std::size_t>& of(Role role) const {
        return candidates[static_cast<std::size_t>(role)];
    }
    [[nodiscard]] bool has(Role role) const { return !of(role).empty(); }
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
/// was asked for by its name. `incomplete` gets the others.
[[nodiscard]] std::vector<JointGroup> group_joints(const KnownColumns& known, bool joint_asked,
                                                   bool needs_torque, std::vector<JointGroup>& incomplete);

/// A sentence where joints are numbered from 0 for one quantity and from 1 for another, so that equal numbers
/// are not one joint's; empty otherwise, and where --columns says what belongs together.
[[nodiscard]] std::string mixed_numberings(const KnownColumns& known);

/// The one column for a role, empty when there is none. Throws DataError where several are equally good.
[[nodiscard]] std::optional<std::size_t> choose_column(const KnownColumns& known, const JointGroup& group,
                                                       Role role, std::vector<LogWarning>& warnings);

/// A line of names.def whose names settle the unit.
struct Convention {
    std::string_view family;  ///< who writes such names: "libfranka"
    std::string_view beside;  ///< a name that another column of the log has to have; may be empty
    std::string_view names;   ///< as names.def explains
    Role role = Role::other;
    std::string_view unit;
    Shaft side = Shaft::joint;
    std::string_view source;  ///< where it is written down
};

[[nodiscard]] std::span<const Convention> conventions();

}  // namespace ripplenotch
