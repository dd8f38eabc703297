// SPDX-License-Identifier: MIT
#pragma once
// Internal to the core room: the way of FixedTexts where there are wide vectors.

#include <cstdint>
#include <span>

namespace ripplenotch {

inline constexpr int most_decimals_side_by_side = 13;

/// Prints each value with 0 to most_decimals_side_by_side decimals, up to the end of its slot of sixteen
/// bytes, and notes its length; 0 where the text has more than fourteen digits or its rounding is in doubt.
/// Slots and lengths have room for a multiple of four, and are aligned to 32 bytes.
void print_fixed(std::span<const double> values, int decimals, char decimal_mark, char* slots,
                 std::uint64_t* lengths);

}  // namespace ripplenotch
