// SPDX-License-Identifier: MIT
#pragma once
// Internal to the analysis room: what was looked at, and what comes of it.

#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/analysis/motion_lines.hpp"

namespace ripplenotch {

/// Writes finding, grounds, notes, conclusive and verdict from the lines and the ratio already in `result`.
void conclude(const MotionLines& motion, const IdentifyOptions& options, Identification& result);

/// Finding, conclusive and verdict once more, after something was added.
void settle(Identification& result);

}  // namespace ripplenotch
