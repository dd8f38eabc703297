// SPDX-License-Identifier: MIT
#pragma once
// How a text log is written, found out from its first bytes: line ends, delimiter, decimal mark, comments,
// names, units.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "log/text/text_cells.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/log/layout.hpp"

namespace ripplenotch {

struct TextDialect {
    CellRules rules;
    char line_end = '\n';  ///< '\r' for files of old Macintoshes
    bool has_header = false;
    bool header_in_comment = false;  ///< "# time velocity torque", as numpy.savetxt writes it
    bool quoted_names = false;
    std::vector<std::string> names;    ///< empty without header
    std::vector<std::string> units;    ///< from a unit row, else empty
    std::size_t columns = 0;           ///< cells in a row
    std::size_t header_end = 0;        ///< offset just past the header line's content; 0 without header
    std::size_t unit_row_end = 0;      ///< the same for the unit row; 0 without
    std::size_t data_offset = 0;       ///< of the first row's first byte
    std::size_t data_line = 1;         ///< its line number, from 1
    std::optional<double> row_step_s;  ///< as the head of the file says it
    std::size_t head_lines = 0;        ///< above the names, or above the first row, that are neither
    /// Numbers of the first rows by column, not-a-number where a cell is none; evidence for choosing columns.
    std::vector<std::vector<double>> sample;
    std::vector<bool> clock_texts;      ///< by column: dates or times of day; seconds in the sample
    std::vector<std::size_t> clock_of;  ///< by column: where its times stand, if each has its own; else empty
    std::vector<std::int64_t> first_counts;  ///< by column: the first row's whole number, exact
};

/// Longest line that is read; a file without line ends is not a text log.
inline constexpr std::size_t longest_line = std::size_t{1} << 20;

/// `first_bytes` is the opening of the file, all of it when `whole`. Throws DataError that begins with
/// the name of `source`: for files that are empty, binary, UTF-16, only a header, or whose delimiter cannot
/// be told.
[[nodiscard]] TextDialect sniff_text(std::string_view first_bytes, bool whole, const ByteSource& source,
                                     const ReadOptions& options);

/// Writes a character as people type it at --delimiter: ",", "tab", "space".
[[nodiscard]] std::string delimiter_name(char delimiter);

/// Line and column (from 1) of an offset, for messages.
struct TextPlace {
    std::size_t line = 1, column = 1;
};
[[nodiscard]] TextPlace place_of(std::string_view bytes, std::size_t offset, char line_end);

}  // namespace ripplenotch
