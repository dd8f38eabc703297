// SPDX-License-Identifier: MIT
#pragma once
// The rows of a text log with other torque values: everything else passes byte for byte.

#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/text/print_fixed.hpp"
#include "log/text/csv_reader.hpp"
#include "log/text/quick_rows.hpp"
#include "log/text/text_dialect.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/log/format.hpp"

namespace ripplenotch {

// Internal to the log room: a column's numbers as text, some at a time. One class for each answer to how many
// decimals there are, all with the same functions; which of them it is, is known when loops are compiled.

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

// Internal to the log room: a block's bytes with other numbers in the places of its torques, or behind its
// rows.

/// How the rows of a log are written anew.
struct RewritePlan {
    CellRules rules;
    int decimals = 6;                 ///< where they are fixed
    std::vector<std::size_t> joints;  ///< in the order in which their numbers stand in a row
    std::vector<double> factors;      ///< by joint: newton-metres in one unit of its torque column
};

class CsvWriter : public LogWriter {
  public:
    CsvWriter(std::unique_ptr<ByteSink> sink, const CsvReader& reader, const WriteOptions& options);
    std::string_view prepare(RowBlock& block, Torques torque_nm, std::string& room) const override;
    void put(const RowBlock& block, Torques torque_nm, std::string_view bytes) override;
    void finish() override;

  private:
    void write_head(const CsvReader& reader);
    [[nodiscard]] std::string names_appended(const CsvReader& reader) const;
    [[nodiscard]] std::string units_appended(const CsvReader& reader) const;

    std::unique_ptr<ByteSink> sink_;
    WriteOptions options_;
    RewritePlan plan_;
};

/// One for each joint that is read; with its joint's name before it where there are several.
[[nodiscard]] std::vector<std::string> appended_names(const Layout& layout, const WriteOptions& options);

}  // namespace ripplenotch
