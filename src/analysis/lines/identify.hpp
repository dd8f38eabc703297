// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <optional>

#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/analysis/motion_lines.hpp"

namespace ripplenotch {

// Internal to the analysis module: what was examined, and what follows from it.

/// Writes finding, grounds, notes, conclusive and verdict from the lines and the ratio already in `result`.
void conclude(const MotionLines& motion, const IdentifyOptions& options, Identification& result);

/// Finding, conclusive and verdict once more, after something was added.
void settle(Identification& result);

// Internal to the analysis module: lines as identify reports them, from what the motion shows.

/// A line as it is reported, and as the gear ratio sees it when it may turn with the joint.
struct Reported {
    Line line = {};
    std::optional<OrderLine> order = {};
    double hz_error = 0.0;  ///< standard error of line.hz
};

}  // namespace ripplenotch
