// SPDX-License-Identifier: MIT
#pragma once
// One line of a text log, split into cells: the careful way, used for headers, samples, quoted rows and
// messages. The quick way for plain rows of numbers is in row_parser.hpp; a test holds that both agree.

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace ripplenotch {

/// What separates cells and marks decimals.
struct CellRules {
    char delimiter = ',';  ///< ' ' means runs of blanks and tabs, also at both ends of a line
    char decimal_mark = '.';
};

[[nodiscard]] inline bool is_blank(char c) { return c == ' ' || c == '\t'; }

/// Content of a cell, without surrounding blanks and quotes, as offsets into the line.
struct Cell {
    std::size_t begin = 0, end = 0;
    bool quoted = false;
    [[nodiscard]] std::string_view of(std::string_view line) const { return line.substr(begin, end - begin); }
};

/// Splits a line (without its line end). An unclosed quote runs to the end of the line and sets `unclosed`.
struct CellSplit {
    std::vector<Cell> cells;
    bool unclosed = false;
};
void split_cells(std::string_view line, char delimiter, CellSplit& into);

/// The cell's text with doubled quotes undone.
[[nodiscard]] std::string cell_text(std::string_view line, const Cell& cell);

/// Blank, or begins with # % or // after blanks.
[[nodiscard]] bool is_blank_line(std::string_view line);
[[nodiscard]] bool is_comment_line(std::string_view line);
/// Blank, a comment, or the end mark.
[[nodiscard]] bool is_no_row(std::string_view line);
/// What stands in no text, wherever it is: any byte below 0x20 but tabs, form feeds and line ends.
[[nodiscard]] inline bool is_control(char c) {
    return static_cast<unsigned char>(c) < 0x20 && c != '\t' && c != '\n' && c != '\r' && c != '\f';
}

}  // namespace ripplenotch
