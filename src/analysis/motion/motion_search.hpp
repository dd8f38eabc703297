// SPDX-License-Identifier: MIT
#pragma once
// Internal to the analysis room: the search for lines in sweeps whose angle is what it is.

#include <span>
#include <vector>

#include "ripplenotch/analysis/motion_lines.hpp"

namespace ripplenotch {

struct MotionSearch {
    MotionLines found;
    Stack angle;                ///< of what the lines left
    std::vector<Sweep> sweeps;  ///< where the angle is not absolute: no line that was found taken out
};

[[nodiscard]] MotionSearch search_sweeps(Sweeps cut, std::span<const TraceView> logs,
                                         const MotionLinesOptions& options);

}  // namespace ripplenotch
