// SPDX-License-Identifier: MIT
#pragma once
// Internal to the log room: a column's numbers as text, some at a time. One class for each answer to how many
// decimals there are, all with the same functions; which of them it is, is known when loops are compiled.

#include <algorithm>
#include <cstddef>
#include <span>

#include "core/text/fixed_texts.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {

/// Cells that are written: their numbers as they are to be written, times `factor`.
struct NewNumbers {
    std::span<const double> values;  ///< at most FixedTexts::most
    double factor = 1.0;
};

class ShortestCells {
  public:
    /// A number that is the old one keeps its text.
    static constexpr bool keeps_unchanged = true;

    explicit ShortestCells(char decimal_mark, int /*decimals*/) : mark_(decimal_mark) {}
    void prepare(const NewNumbers& numbers) { numbers_ = numbers; }
    /// Number i; there is room for number_room bytes at `into`. Returns its end.
    char* put(char* into, std::size_t i) const {
        char* const end = put_shortest(into, numbers_.values[i] / numbers_.factor);
        if (mark_ != '.') std::replace(into, end, '.', mark_);
        return end;
    }

  private:
    char mark_;
    NewNumbers numbers_;
};

class FixedCells {
  public:
    static constexpr bool keeps_unchanged = false;

    FixedCells(char decimal_mark, int decimals) : texts_(decimal_mark), decimals_(decimals) {}
    void prepare(const NewNumbers& numbers) { texts_.prepare(numbers.values, numbers.factor, decimals_); }
    char* put(char* into, std::size_t i) const { return texts_.put(into, i); }

  private:
    FixedTexts texts_;
    int decimals_;
};

}  // namespace ripplenotch
