// SPDX-License-Identifier: MIT
#pragma once
// The series of exponential and logarithm, for one number and for many.

#include <array>
#include <cstddef>

namespace ripplenotch::portable {

// 1, 1/3, 1/5, ... of atanh(f) / f, with f^2 <= 0.0295: the first term left out is below 2e-19.
inline constexpr std::array<double, 12> logarithm_terms = [] {
    std::array<double, 12> terms{};
    for (std::size_t n = 0; n < terms.size(); ++n) terms[n] = 1.0 / static_cast<double>(2 * n + 1);
    return terms;
}();

// 1/n! with |x| <= ln(2)/2: the first term left out is below 5e-18.
inline constexpr std::array<double, 14> exponential_terms = [] {
    std::array<double, 14> terms{1.0};
    for (std::size_t n = 1; n < terms.size(); ++n) terms[n] = terms[n - 1] / static_cast<double>(n);
    return terms;
}();

// ln(2) in two parts: the first has 21 trailing zero bits, so that its product with a power up to 1024 is
// exact.
inline constexpr double ln2_high = 0x1.62e42fefap-1;
inline constexpr double ln2_low = 0x1.cf79abc9e3b39p-40;

}  // namespace ripplenotch::portable
