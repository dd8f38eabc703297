// SPDX-License-Identifier: MIT
#pragma once
// Internal to the analysis room: bands with more torque in them than the ripple, beside the lines.

#include <vector>

#include "ripplenotch/analysis/motion_lines.hpp"

namespace ripplenotch {

/// Humps of what the lines leave of the sweeps:  those that outdo the strongest line that may turn with the
/// joint. At most three, most torque first.
[[nodiscard]] std::vector<Hum> hums_beside(const MotionLines& motion, const std::vector<Line>& lines);

}  // namespace ripplenotch
