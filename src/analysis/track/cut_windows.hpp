// SPDX-License-Identifier: MIT
#pragma once
// Internal to the analysis room: windows of a run of motion.

#include <span>
#include <vector>

#include "ripplenotch/analysis/motion_runs.hpp"

namespace ripplenotch {

/// Windows of one length, evenly spread from the start to the end of a run in `place` (turns or time, one
/// value a sample, in one direction), at most `hop` of the length apart. A run between the shortest and one
/// window long is one window, a shorter one none.
[[nodiscard]] std::vector<SampleRun> cut_windows(const SampleRun& run, std::span<const double> place,
                                                 double length, double shortest, double hop);

}  // namespace ripplenotch
