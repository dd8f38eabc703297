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

#include "log/columns/decide_layout.hpp"
#include "log/text/quick_rows.hpp"
#include "log/text/text_cells.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/log/layout.hpp"

namespace ripplenotch {

struct TextDialect {
    CellRules rules;
    bool has_header = false;
    bool header_in_comment = false;  ///< "# time velocity torque", as numpy.savetxt writes it
    bool quoted_names = false;
    std::vector<std::string> names;        ///< empty without header
    std::vector<std::string> units;        ///< from a unit row, else empty
    std::size_t columns = 0;               ///< cells in a row
    std::size_t header_end = 0;            ///< offset just past the header line's content; 0 without header
    std::size_t unit_row_end = 0;          ///< the same for the unit row; 0 without
    std::size_t data_offset = 0;           ///< of the first row's first byte
    std::size_t data_line = 1;             ///< its line number, from 1
    std::optional<double> row_step_s;      ///< as the head of the file says it
    std::string row_step_key = "Delta_X";  ///< under this word
    std::vector<HeadScale> scales;         ///< by column, of a head that says some; else empty
    std::size_t head_lines = 0;            ///< above the names, or above the first row, that are neither
    /// Numbers of the first rows by column, not-a-number where a cell is none; evidence for choosing columns.
    std::vector<std::vector<double>> sample;
    std::vector<bool> clock_texts;       ///< by column: dates or times of day; seconds in the sample
    std::vector<StampForm> stamp_forms;  ///< by column, of its dates and times of day
    std::vector<std::size_t>
        clock_of;             ///< by column: where its times stand, if some have their own; else empty
    bool has_lists = false;   ///< a cell of the first row is a list: "[0.1, 0.2]", "(0.1 0.2)"
    bool own_clocks = false;  ///< some have, in columns of their own or in rows of their own
    std::vector<std::int64_t> first_counts;  ///< by column: the first row's whole number, exact
};

/// Longest line that is read; a file without line ends is not a text log.
inline constexpr std::size_t longest_line = std::size_t{1} << 20;

/// `first_bytes` is the opening of the file, all of it when `whole`. Throws DataError that begins with
/// the name of `source`: for files that are empty, binary, UTF-16, without line feeds, only a header, or
/// whose delimiter cannot be told.
[[nodiscard]] TextDialect sniff_text(std::string_view first_bytes, bool whole, const ByteSource& source,
                                     const ReadOptions& options);

/// Writes a character as people type it at --delimiter: ",", "tab", "space".
[[nodiscard]] std::string delimiter_name(char delimiter);

/// Line and column (from 1) of an offset, for messages.
struct TextPlace {
    std::size_t line = 1, column = 1;
};
[[nodiscard]] TextPlace place_of(std::string_view bytes, std::size_t offset);

// The opening of a text log as lines: comments apart from content, what is no text refused.

struct TextLine {
    std::size_t begin = 0, end = 0;  ///< content, without line end
    std::size_t next = 0;            ///< offset of the next line
    std::size_t number = 1;
    [[nodiscard]] std::string_view of(std::string_view bytes) const {
        return bytes.substr(begin, end - begin);
    }
};

struct TextLines {
    std::vector<TextLine> comments;  ///< before the first content
    std::vector<TextLine> content;   ///< neither blank nor comment; never empty
    std::optional<char> delimiter;   ///< from a first line "sep=;", as Excel writes and reads it
};

/// `bytes` is the opening of a file, all of it when `whole`; its first `skip_lines` lines count for nothing.
/// Throws DataError that begins with `source`: for an empty file, bytes that no text has, UTF-16, a line
/// longer than longest_line, nothing but comments.
[[nodiscard]] TextLines opening_lines(std::string_view bytes, bool whole, const ByteSource& source,
                                      std::size_t skip_lines = 0);

// Internal to the log room: the wanted numbers of lines that nobody has judged yet.

class TextRow {
  public:
    /// `wanted` in any order, of so many joints. `lenient`: where a cell is no number, it is not-a-number.
    TextRow(const TextDialect& dialect, std::vector<WantedColumn> wanted, StampRule stamp,
            std::size_t joints = 1, bool lenient = false);

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
    RowParser parser_;
    bool lenient_;
    ParsedRow row_;
    CellSplit split_;
};

/// Without the carriage return of a line end of two bytes.
[[nodiscard]] inline std::string_view line_content(std::string_view line) {
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    return line;
}

// Rows of the opening of a text log, for what they say about units.

/// All whole lines of `bytes`, which begin with the first row. Rows that are none are left out. Without a
/// time column, time counts the rows.
[[nodiscard]] MotionSample text_motion_sample(std::string_view bytes, const TextDialect& dialect,
                                              const Layout& layout, const std::vector<MotionPlace>& places);

}  // namespace ripplenotch
