// SPDX-License-Identifier: MIT
#pragma once
// The series of cosine and sine within an eighth of a turn, for one angle and for many.

#include <array>
#include <cstddef>

namespace ripplenotch::portable {

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

}  // namespace ripplenotch::portable
