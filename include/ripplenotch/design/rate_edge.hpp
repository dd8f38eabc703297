// SPDX-License-Identifier: MIT
#pragma once
// A line near half the sample rate can be neither notched nor told from its mirror image: methods that follow
// the ripple let go of it before it gets there, all in the same way.

#include <algorithm>

namespace ripplenotch {

/// In cycles a sample: up to the first a line is taken out whole, from the second on not at all.
inline constexpr double full_below_rate = 0.45, none_above_rate = 0.48;

/// The share of a line at this frequency, in cycles a sample, that is taken out.
[[nodiscard]] inline double share_below_rate(double cycles) noexcept {
    return std::clamp((none_above_rate - cycles) / (none_above_rate - full_below_rate), 0.0, 1.0);
}

}  // namespace ripplenotch
