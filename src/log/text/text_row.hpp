// SPDX-License-Identifier: MIT
#pragma once
// Internal to the log room: the wanted numbers of lines that nobody has judged yet.

#include <string_view>
#include <vector>

#include "log/text/row_parser.hpp"
#include "log/text/text_dialect.hpp"

namespace ripplenotch {

class TextRow {
  public:
    /// `wanted` in any order.
    TextRow(const TextDialect& dialect, std::vector<WantedColumn> wanted, StampRule stamp);

    /// The wanted numbers of a line without its line end, by slot; false where one of them cannot be read or
    /// the line has not as many cells as a row.
    bool parse(std::string_view line);
    [[nodiscard]] double value(std::size_t slot) const { return row_.values[slot]; }
    /// The text of a cell of a line that is a row; empty where there is none such.
    [[nodiscard]] std::string_view cell(std::string_view line, std::size_t column);

  private:
    bool parse_carefully(std::string_view line);

    CellRules rules_;
    std::size_t columns_;
    std::vector<WantedColumn> wanted_;
    StampRule stamp_;
    RowParser parser_;
    ParsedRow row_;
    CellSplit split_;
};

/// Without the carriage return of a line end of two bytes.
[[nodiscard]] inline std::string_view line_content(std::string_view line) {
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    return line;
}

}  // namespace ripplenotch
