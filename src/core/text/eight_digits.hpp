// SPDX-License-Identifier: MIT
#pragma once
// Internal to the core room: eight decimal digits at a time, in a register.

#include <bit>
#include <cstdint>
#include <cstring>

namespace ripplenotch {

/// From numbers side by side, each split into quotient (in its lower half) and remainder (in its upper half)
/// by `divisor`: parts << half | quotients, less divisor times the quotients in the upper half.
constexpr std::uint64_t split(std::uint64_t parts, std::uint64_t quotients, std::uint64_t divisor, int half) {
    return (parts << half) - quotients * ((divisor << half) - 1);
}

/// The eight digits of a number below 1e8, one a byte, the first in the lowest: halves of it side by side,
/// then halves of these, each division by 10000, 100 and 10 a multiplication.
constexpr std::uint64_t eight_digits(std::uint32_t value) {
    const std::uint64_t fours = split(value, value / 10000, 10000, 32);
    const std::uint64_t twos = split(fours, ((fours * 10486) >> 20) & 0x0000007F0000007FU, 100, 16);
    return split(twos, ((twos * 103) >> 10) & 0x000F000F000F000FU, 10, 8);
}

/// Digits as characters.
inline constexpr std::uint64_t eight_zeros = 0x3030303030303030U;

/// Eight characters, the first in the lowest byte.
inline void put_eight(char* into, std::uint64_t text) {
    if constexpr (std::endian::native == std::endian::big) text = __builtin_bswap64(text);
    std::memcpy(into, &text, sizeof text);
}

}  // namespace ripplenotch
