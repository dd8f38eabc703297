// SPDX-License-Identifier: MIT
#pragma once
// The median, in one place: the upper of the middle two.

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace ripplenotch {

/// Puts the values in another order. 0 when there are none.
[[nodiscard]] inline double median_in(std::span<double> values) {
    if (values.empty()) return 0.0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// Standard deviations in the median of what normal values are off by.
inline constexpr double deviations_of_median = 1.4826;

[[nodiscard]] inline double median_of(std::vector<double> values) { return median_in(values); }

}  // namespace ripplenotch
