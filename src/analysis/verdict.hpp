// SPDX-License-Identifier: MIT
#pragma once
// Internal to the analysis room: what was looked at, and the sentence that says what came of it.

#include <optional>

#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/analysis/motion_lines.hpp"
#include "ripplenotch/analysis/steady_lines.hpp"

namespace ripplenotch {

struct Looked {
    std::optional<SteadyLines> steady;
    std::optional<MotionLines> motion;
};

/// Writes verdict, conclusive and notes from the lines and the ratio already in `result`.
void conclude(const Looked& looked, const IdentifyOptions& options, Identification& result);

}  // namespace ripplenotch
