// SPDX-License-Identifier: MIT
#pragma once
// Internal to the analysis module: the estimate from segments that were chosen.

#include <cstddef>

#include "analysis/track/ripple_segments.hpp"
#include "ripplenotch/analysis/ripple_estimate.hpp"

namespace ripplenotch {

/// The ripple in these segments, which are at least one. `tries`: estimates of which none may be a false
/// alarm.
[[nodiscard]] RippleEstimate estimate_of(double order, const OrderSegments& segments, std::size_t tries,
                                         double least_nm);

/// Amplitude below which a ripple does not count, as a share of the torque's range; as
/// MotionLinesOptions::least_share.
inline constexpr double least_range_share = 1e-4;

}  // namespace ripplenotch
