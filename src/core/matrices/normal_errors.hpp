// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>

namespace ripplenotch {

/// Half the width of a two-sided 95 % interval of a normal distribution, in standard errors: the quantile of
/// 0.975.
inline constexpr double normal_95_errors = 1.959963984540054;

/// The same of Student's t with these degrees of freedom, 1 or more.
inline double student_95(double freedom) {
    constexpr std::array table{12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228};
    if (freedom <= 10.0) return table[static_cast<std::size_t>(std::max(freedom, 1.0)) - 1];
    return 1.960 + 2.4 / freedom + 3.5 / (freedom * freedom);
}

}  // namespace ripplenotch
