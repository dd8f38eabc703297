// SPDX-License-Identifier: MIT
#pragma once
// Internal to the core room: the way of FixedTexts where there are wide vectors.

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "core/vectors/dispatch.hpp"

namespace ripplenotch {

/// Prints each value with 0 to most_decimals_side_by_side decimals, up to the end of its slot of sixteen
/// bytes, and notes its length; 0 where the text has more than fourteen digits or its rounding is in doubt.
/// Slots and lengths have room for a multiple of four, and are aligned to 32 bytes.
void print_fixed(std::span<const double> values, int decimals, char decimal_mark, char* slots,
                 std::uint64_t* lengths);

// Internal: put_fixed() for many numbers with the same decimals, printed side by side where there are
// vectors.

/// The bytes of put_fixed(), whichever instruction set prints them.
class FixedTexts {
  public:
    /// Numbers at once.
    static constexpr std::size_t most = 256;
    /// A text of this many bytes or fewer may be printed by vectors; others are printed when they are put.
    static constexpr std::size_t slot_bytes = 16;

    explicit FixedTexts(char decimal_mark = '.') : mark_(decimal_mark) {}

    /// Prints values[i] / divisor with `decimals` digits behind the mark; at most `most` values. They are
    /// looked at again until the last put().
    void prepare(std::span<const double> values, double divisor, int decimals);

    /// Number i at `into`, which has room for number_room bytes; returns its end.
    char* put(char* into, std::size_t i) const {
        const auto length = static_cast<std::size_t>(lengths_[i]);
        if (length == 0) [[unlikely]]
            return put_alone(into, i);
        // Always as many bytes as a slot has: what stands behind the text is written over by what comes next.
        std::memcpy(into, slots_.data() + slot_bytes * (i + 1) - length, slot_bytes);
        return into + length;
    }

  private:
    char* put_alone(char* into, std::size_t i) const;

    char mark_;
    int decimals_ = 0;
    double divisor_ = 1.0;
    std::span<const double> values_;
    /// The length of the text in slot i, which ends where the slot ends; 0 where there is none.
    alignas(32) std::array<std::uint64_t, most> lengths_;
    alignas(32) std::array<char, slot_bytes*(most + 1)> slots_;
};

// Internal to the core room: eight decimal digits at a time, in a register.

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
