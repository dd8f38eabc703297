// SPDX-License-Identifier: MIT
#pragma once
// Internal to the analysis module: lines of the torque that the steps of the position's encoder make.

#include <cstddef>
#include <span>
#include <vector>

#include "ripplenotch/analysis/line_search.hpp"
#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {

/// Takes lines off the list that the steps foretell: a drive that controls a rounded position puts its
/// rounding into the torque, at multiples of the steps per turn, folded at the sample rate. Each line is
/// asked whether the rounding of the smooth angle shows it too, in the sweeps that hold most of it. Returns
/// how many were taken off.
std::size_t take_off_encoder_lines(std::span<const TraceView> logs, const SweepRule& rule,
                                   std::vector<MotionLine>& lines);

}  // namespace ripplenotch
