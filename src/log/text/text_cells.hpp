// SPDX-License-Identifier: MIT
#pragma once
// One line of a text log, split into cells, and the number that a cell holds: the careful way, used for
// headers, samples, quoted rows and messages. The quick way for plain rows of numbers is in quick_rows.hpp; a
// test holds that both agree.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ripplenotch {

/// A number as programs and people write it: plain, with the exponent of Fortran (1.5D-03), with the minus of
/// typesetters, with separators of thousands (1,234.5), with its unit behind it.
struct CellNumber {
    double value = 0.0;
    std::size_t size = 0;   ///< bytes of the cell that are the number
    std::string_view unit;  ///< "deg/s"; mostly empty
};
/// None where the cell holds something else. One separator of thousands alone is none: "1,234" may be 1.234.
[[nodiscard]] std::optional<CellNumber> cell_number(std::string_view cell, char decimal_mark);

/// What separates cells and marks decimals.
struct CellRules {
    char delimiter = ',';  ///< ' ' means runs of blanks and tabs, also at both ends of a line
    char decimal_mark = '.';
    std::vector<std::string> units =
        {};  ///< by column, where cells have theirs behind the number; else empty

    /// cell_number() of a cell in this column; none where it has another unit than the column.
    [[nodiscard]] std::optional<CellNumber> number(std::string_view cell, std::size_t column) const;
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

/// The texts of a line's cells in UTF-8, with doubled quotes undone.
[[nodiscard]] std::vector<std::string> cell_texts(std::string_view line, char delimiter);

/// The numbers of a list in one cell, "[0.1, 0.2]" or "(0.1 0.2)"; none where it is no such.
[[nodiscard]] std::optional<std::vector<double>> list_in(std::string_view cell);

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
