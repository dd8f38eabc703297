// SPDX-License-Identifier: MIT
#pragma once
// Decision thresholds that several searches of this module share.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {

/// Difference in log-likelihood (odds of 150 to 1) by which one explanation of a line has to exceed another.
inline constexpr double decisive_nats = 5.0;  // chosen, not derived
/// Uncertainty of an improvement as a share: the noise below a line is not known better.
inline constexpr double floor_doubt = 0.15;  // chosen, not derived
/// Maxima are looked for among correlated bins: about this many independent tries per cell. With it, white
/// noise raises a false alarm somewhat less often than allowed.
inline constexpr double tries_per_cell = 1.6;
/// Number of terms of the polynomial trend that is removed from a window: a cubic, since a quadratic leaks
/// into order 2 where a joint reverses.
inline constexpr std::ptrdiff_t window_trend_terms = 4;

/// Smaller lines are not reported: a share of the torque's range, and in any case the rounding error of a
/// constant.
inline double least_amplitude_nm(std::span<const TraceView> logs, double share) {
    double range = 0.0, largest = 0.0;
    for (const TraceView& log : logs) {
        const auto [low, high] = std::minmax_element(log.torque_nm.begin(), log.torque_nm.end());
        if (low == log.torque_nm.end()) continue;
        range = std::max(range, *high - *low);
        largest = std::max({largest, std::abs(*low), std::abs(*high)});
    }
    return std::max(share * range, 1e-9 * largest);
}

}  // namespace ripplenotch
