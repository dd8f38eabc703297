// SPDX-License-Identifier: MIT
#pragma once
// The quick way through a row of numbers: finds the wanted cells, reads them, counts all cells. It accepts
// only what is certainly well formed; whatever else is left to the careful way, which also finds the words
// for what is wrong.

#include <cstddef>
#include <string_view>
#include <vector>

#include "log/clock/stamp.hpp"
#include "log/text/row_slots.hpp"
#include "log/text/text_cells.hpp"

namespace ripplenotch {

/// The numbers of a row and the places of the torque cells.
struct ParsedRow {
    struct Place {
        const char* begin = nullptr;
        const char* end = nullptr;
    };
    explicit ParsedRow(std::size_t joints = 1) : values(slot_count(joints)), torques(joints) {}

    std::vector<double> values;         ///< by slot
    std::vector<Place> torques;         ///< by joint; null without a torque column
    const char* content_end = nullptr;  ///< just past the last cell
};

/// What a time that comes in parts begins with: a time of -0 stays one.
constexpr double nothing_yet = -0.0;

class RowParser {
  public:
    /// `wanted` sorted by column.
    RowParser(CellRules rules, std::size_t columns, std::vector<WantedColumn> wanted, StampRule stamp = {})
        : rules_(rules), columns_(columns), wanted_(std::move(wanted)), stamp_(stamp) {}

    /// True when every wanted cell held a plain finite number and the row has the right number of cells,
    /// without quotes. `row` has room for the slots that are wanted.
    [[nodiscard]] bool parse(const char* begin, const char* end, ParsedRow& row) const;

  private:
    [[nodiscard]] bool add_stamp(std::string_view text, bool fraction, double& time) const;

    CellRules rules_;
    std::size_t columns_;
    std::vector<WantedColumn> wanted_;
    StampRule stamp_;
};

}  // namespace ripplenotch
