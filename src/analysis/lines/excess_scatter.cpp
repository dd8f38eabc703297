// SPDX-License-Identifier: MIT
#include "analysis/lines/excess_scatter.hpp"

#include <cmath>

#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

double excess_scatter(double squares, double freedom) {
    if (!(freedom >= 1.0)) return 1.0;
    constexpr double normal_99 = 2.3263;  // 99 % quantile of a normal variable
    // 99 % quantile of chi-square by the cube root of Wilson and Hilferty, within 1 % of the exact one.
    const double share = 2.0 / (9.0 * freedom);
    const double limit = freedom * portable::pow(1.0 - share + normal_99 * std::sqrt(share), 3.0);
    return squares > limit ? std::sqrt(squares / freedom) : 1.0;
}

}  // namespace ripplenotch
