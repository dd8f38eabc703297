// SPDX-License-Identifier: MIT
#pragma once
// A part of decide_layout: units that --unit states, and what is said of units that nobody stated.

#include <optional>
#include <string>

#include "log/columns/decide_layout.hpp"

namespace ripplenotch::layout_detail {

/// The unit that --unit gives to the column, by its name or by its role.
[[nodiscard]] std::optional<std::string> asked_unit(const ReadOptions& options, const std::string& name,
                                                    Role role);

/// Units that a column of this role may have, as messages list them.
[[nodiscard]] std::string unit_list(Role role);

/// Adds warnings: units that were assumed, currents without a torque constant, a torque constant without
/// currents. Throws UsageError for a --unit that names neither a role nor a column.
void state_units(Layout& layout, const ColumnFacts& facts, const ReadOptions& options);

/// Marks a layout whose joints lack a velocity that their position can give, with a warning.
void state_derived_velocity(Layout& layout, const ColumnFacts& facts);

}  // namespace ripplenotch::layout_detail
