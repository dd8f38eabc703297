// SPDX-License-Identifier: MIT
#pragma once
// The C99 function that computes a map.

#include <string>
#include <string_view>

#include "ripplenotch/design/ripple_map.hpp"

namespace ripplenotch {

/// `name`_torque(speed_deg_s, motor_turns, joint_deg, torque_nm), over the arrays `name`_orders, _speeds,
/// _limits and _values.
[[nodiscard]] std::string map_code(const RippleMap& map, std::string_view name, bool is_float);

}  // namespace ripplenotch
