// SPDX-License-Identifier: MIT
#pragma once
// The quick way through a row of numbers: finds the wanted cells, reads them, counts all cells. It accepts
// only what is certainly well formed; whatever else is left to the careful way, which also finds the words
// for what is wrong.

#include <array>
#include <cstddef>
#include <vector>

#include "log/text_cells.hpp"

namespace ripplenotch {

/// One wanted column: its place in the row and where its number goes.
struct WantedColumn {
    std::size_t column = 0;
    std::size_t slot = 0;  ///< into the row's numbers
};

/// The numbers of a row and the place of the torque cell.
struct ParsedRow {
    std::array<double, 4> values{};
    const char* torque_begin = nullptr;
    const char* torque_end = nullptr;
    const char* content_end = nullptr;  ///< just past the last cell
};

class RowParser {
  public:
    /// `wanted` sorted by column; `torque_slot` is the slot whose cell's place is kept.
    RowParser(CellRules rules, std::size_t columns, std::vector<WantedColumn> wanted, std::size_t torque_slot)
        : rules_(rules), columns_(columns), wanted_(std::move(wanted)), torque_slot_(torque_slot) {}

    /// True when every wanted cell held a plain finite number and the row has the right number of cells,
    /// without quotes.
    [[nodiscard]] bool parse(const char* begin, const char* end, ParsedRow& row) const;

  private:
    CellRules rules_;
    std::size_t columns_;
    std::vector<WantedColumn> wanted_;
    std::size_t torque_slot_;
};

}  // namespace ripplenotch
