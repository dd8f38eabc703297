// SPDX-License-Identifier: MIT
#pragma once
// What a number from outside may be, so that no square, sum or product of such numbers overflows.

#include <cmath>

namespace ripplenotch {

/// In any unit that the tool knows; the time of year 2026 in nanoseconds is 1.8e18.
constexpr double largest_reading = 1e30;

/// False for nan and infinities too.
[[nodiscard]] inline bool is_reading(double value) { return std::abs(value) <= largest_reading; }

}  // namespace ripplenotch
