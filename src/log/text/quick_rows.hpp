// SPDX-License-Identifier: MIT
#pragma once
// Many well-formed rows of numbers at once, from any thread. Stops at the first row that it is not sure of.

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "log/text/row_parser.hpp"
#include "ripplenotch/log/format.hpp"

namespace ripplenotch {

/// What rows look like and where their numbers go.
struct RowPlan {
    CellRules rules;
    char line_end = '\n';
    std::size_t columns = 0;
    std::vector<WantedColumn> wanted;  ///< sorted by column
    std::vector<double> factors =
        std::vector<double>(slot_count(1), 1.0);  ///< into the tool's units, by slot

    StampRule stamp = {};

    [[nodiscard]] std::size_t joints() const { return factors.size() / slots_a_joint; }

    [[nodiscard]] std::optional<std::size_t> column_of(std::size_t slot) const {
        for (const WantedColumn& one : wanted) {
            if (one.slot == slot) return one.column;
        }
        return std::nullopt;
    }
};

/// While it lives, readers that are made take every row the careful way: a test holds the quick ways to it.
class CarefulRows {
  public:
    CarefulRows() noexcept;
    ~CarefulRows();
    CarefulRows(const CarefulRows&) = delete;
    CarefulRows& operator=(const CarefulRows&) = delete;

  private:
    bool before_;
};

class QuickRows {
  public:
    explicit QuickRows(RowPlan plan);

    /// Appends the rows of block.bytes from offset `begin` to the block, as long as each is certainly well
    /// formed and its time not before the one above it (`time_before`, in the file's unit). Returns where it
    /// stopped: the beginning of a line, or the end. The numbers are those of RowParser, bit for bit.
    std::size_t read(RowBlock& block, std::size_t begin, double time_before) const;

    /// One row, not appended.
    [[nodiscard]] bool parse(std::string_view line, ParsedRow& row) const {
        return !careful_ && parser_.parse(line.data(), line.data() + line.size(), row);
    }

  private:
    std::size_t read_by_parser(RowBlock& block, std::size_t begin, double time_before) const;

    RowPlan plan_;
    RowParser parser_;
    bool careful_, vectorised_;
};

}  // namespace ripplenotch
