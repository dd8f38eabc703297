// SPDX-License-Identifier: MIT
#pragma once
// Internal to the analysis room: lines as identify reports them, from what the motion shows.

#include <cstddef>
#include <optional>

#include "ripplenotch/analysis/gear_ratio.hpp"
#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/analysis/motion_lines.hpp"

namespace ripplenotch {

/// A line as it is reported, and as the gear ratio sees it when it may turn with the joint.
struct Reported {
    Line line = {};
    std::optional<OrderLine> order = {};
    double hz_error = 0.0;  ///< of line.hz
};

/// Line number `source` of a motion; folds are told with the rate of the samples.
[[nodiscard]] Reported from_motion(const MotionLines& motion, std::size_t source, double rate_hz);

}  // namespace ripplenotch
