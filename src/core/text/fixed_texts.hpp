// SPDX-License-Identifier: MIT
#pragma once
// Internal: put_fixed() for many numbers with the same decimals, printed side by side where there are
// vectors.

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "core/vectors/dispatch.hpp"

namespace ripplenotch {

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
    /// Of the text in slot i, which ends where the slot ends; 0 where there is none.
    alignas(32) std::array<std::uint64_t, most> lengths_;
    alignas(32) std::array<char, slot_bytes*(most + 1)> slots_;
};

}  // namespace ripplenotch
