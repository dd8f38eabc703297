// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>

namespace ripplenotch::portable {

// The series of cosine and sine within an eighth of a turn, for one angle and for many.

// Coefficients of 1 - z/2! + z^2/4! - ... and of 1 - z/3! + z^2/5! - ..., with z = x^2 <= (pi/4)^2: the first
// term left out is below 3e-18.
inline constexpr std::array<double, 9> cosine_terms = [] {
    std::array<double, 9> terms{1.0};
    for (std::size_t n = 1; n < terms.size(); ++n) {
        terms[n] = -terms[n - 1] / static_cast<double>((2 * n - 1) * (2 * n));
    }
    return terms;
}();
inline constexpr std::array<double, 9> sine_terms = [] {
    std::array<double, 9> terms{1.0};
    for (std::size_t n = 1; n < terms.size(); ++n) {
        terms[n] = -terms[n - 1] / static_cast<double>((2 * n) * (2 * n + 1));
    }
    return terms;
}();

// The series of exponential and logarithm, for one number and for many.

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
