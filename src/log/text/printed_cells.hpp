// SPDX-License-Identifier: MIT
#pragma once
// Internal to the log room: a column's numbers as text, some at a time. One class for each answer to how many
// decimals there are, all with the same functions; which of them it is, is known when loops are compiled.

#include <algorithm>
#include <cstddef>
#include <span>
#include <string_view>

#include "core/fixed_texts.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {

/// Cells that are written: their numbers as they are to be written, times `factor`.
struct NewNumbers {
    std::span<const double> values;  ///< at most FixedTexts::most
    double factor = 1.0;
    std::string_view first_cell;  ///< what the first one replaces
};

class ShortestCells {
  public:
    /// A number that is the old one keeps its text.
    static constexpr bool keeps_unchanged = true;

    explicit ShortestCells(char decimal_mark, int /*decimals*/) : mark_(decimal_mark) {}
    void prepare(const NewNumbers& numbers) { numbers_ = numbers; }
    /// Number i in place of `cell`; there is room for number_room bytes at `into`. Returns its end.
    char* put(char* into, std::size_t i, std::string_view /*cell*/) const {
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
    char* put(char* into, std::size_t i, std::string_view /*cell*/) const { return texts_.put(into, i); }

  private:
    FixedTexts texts_;
    int decimals_;
};

/// Decimals as in the cell that is replaced: most often as in the first one.
class CellsAsBefore {
  public:
    static constexpr bool keeps_unchanged = true;

    CellsAsBefore(char decimal_mark, int /*decimals*/) : texts_(decimal_mark), mark_(decimal_mark) {}
    void prepare(const NewNumbers& numbers) {
        texts_.prepare(numbers.values, numbers.factor, decimals_of(numbers.first_cell));
    }
    char* put(char* into, std::size_t i, std::string_view cell) const {
        return texts_.put(into, i, decimals_of(cell));
    }

  private:
    [[nodiscard]] int decimals_of(std::string_view cell) const {
        std::size_t decimals = 0;
        while (decimals < cell.size() && is_digit(cell[cell.size() - 1 - decimals])) ++decimals;
        const bool plain = decimals < cell.size() && cell[cell.size() - 1 - decimals] == mark_;
        if (!plain) decimals = decimals_before_exponent(cell);
        return static_cast<int>(std::min<std::size_t>(decimals, 17));
    }
    [[nodiscard]] std::size_t decimals_before_exponent(std::string_view cell) const {
        const std::size_t mark = cell.find(mark_);
        if (mark == std::string_view::npos) return 0;
        const std::string_view behind = cell.substr(mark + 1);
        const auto end = std::find_if_not(behind.begin(), behind.end(), is_digit);
        return static_cast<std::size_t>(end - behind.begin());
    }
    static bool is_digit(char one) { return one >= '0' && one <= '9'; }

    FixedTexts texts_;
    char mark_;
};

}  // namespace ripplenotch
