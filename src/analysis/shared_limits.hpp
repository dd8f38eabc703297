// SPDX-License-Identifier: MIT
#pragma once
// Decision thresholds that several searches of this module share.

#include <algorithm>
#include <cmath>
#include <span>

#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {

/// Difference in log-likelihood (odds of 150 to 1) by which one explanation of a line has to exceed another.
inline constexpr double decisive_nats = 5.0;  // chosen, not derived

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
