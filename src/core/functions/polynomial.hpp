// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>

namespace ripplenotch {

/// terms[0] + terms[1] z + ... by Horner's rule.
template <std::size_t n>
double polynomial(const std::array<double, n>& terms, double z) {
    double sum = terms[n - 1];
    for (std::size_t i = n - 1; i > 0; --i) sum = sum * z + terms[i - 1];
    return sum;
}

/// 1.5 * 2^52: adding and subtracting it rounds a smaller number to the nearest integer, in the default
/// rounding mode.
inline double nearest_integer(double x) {
    constexpr double round_by_adding = 6755399441055744.0;
    return (x + round_by_adding) - round_by_adding;
}

}  // namespace ripplenotch
