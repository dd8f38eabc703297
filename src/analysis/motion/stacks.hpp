// SPDX-License-Identifier: MIT
#pragma once
// Internal to analysis: sweeps in both domains at once.

#include <vector>

#include "ripplenotch/analysis/motion_lines.hpp"
#include "ripplenotch/analysis/stack.hpp"

namespace ripplenotch {

/// The sweeps in both domains, after what has been found so far was taken out of them.
struct Stacks {
    Stack angle, time;
};

/// On two cores.
[[nodiscard]] Stacks stacked(const std::vector<Sweep>& sweeps, const MotionLinesOptions& options);

}  // namespace ripplenotch
