// SPDX-License-Identifier: MIT
#pragma once
// How a text log is written, found out from its first bytes: delimiter, decimal mark, comments, names, units.

#include <cstddef>
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

/// The columns of a text log, and how its lines are written.
struct TextDialect : ColumnFacts {
    CellRules rules;
    bool has_header = false;
    bool quoted_names = false;
    std::size_t header_end = 0;    ///< offset just past the header line's content; 0 without header
    std::size_t unit_row_end = 0;  ///< the same for the unit row; 0 without
    std::size_t data_offset = 0;   ///< of the first row's first byte
    std::size_t data_line = 1;     ///< its line number, from 1
    std::size_t head_lines = 0;    ///< above the names, or above the first row, that are neither
    std::vector<std::size_t>
        clock_of;             ///< by column: where its times stand, if some have their own; else empty
    bool has_lists = false;   ///< a cell of the first row is a list: "[0.1, 0.2]", "(0.1 0.2)"
    bool own_clocks = false;  ///< some have, in columns of their own or in rows of their own
};

/// Longest line that is read; a file without line ends is not a text log.
inline constexpr std::size_t longest_line = std::size_t{1} << 20;

/// `first_bytes` is the opening of the file, all of it when `whole`. Throws DataError that begins with
/// the name of `source`: for files that are empty, binary, UTF-16, without line feeds, only a header, or
/// whose delimiter cannot be told.
[[nodiscard]] TextDialect sniff_text(std::string_view first_bytes, bool whole, const ByteSource& source,
                                     const ReadOptions& options);

// The opening of a text log as lines: comments apart from content, what is no text refused.

struct TextLine {
    std::size_t begin = 0, end = 0;  ///< content, without line end
    std::size_t next = 0;            ///< offset of the next line
    std::size_t number = 1;
};

struct TextLines {
    std::string_view bytes;
    std::vector<TextLine> comments;  ///< before the first content
    std::vector<TextLine> content;   ///< neither blank nor comment; never empty
    std::optional<char> delimiter;   ///< from a first line "sep=;", as Excel writes and reads it

    [[nodiscard]] std::string_view text(const TextLine& line) const {
        return bytes.substr(line.begin, line.end - line.begin);
    }
    /// Of the content, by its place in it.
    [[nodiscard]] std::string_view line(std::size_t place) const { return text(content[place]); }
    [[nodiscard]] std::vector<std::string> cells(std::size_t place, char between) const {
        return cell_texts(line(place), between);
    }
};

// The names over the columns: a first line of words, a row of units under it, or the last comment before the
// numbers; and what some programs write above a table.

/// True when the text holds a letter, of whatever alphabet.
[[nodiscard]] bool has_letters(std::string_view text);

/// Fills in the names, units and their places in `dialect`, whose rules and columns are known. Returns how
/// many lines of content the header takes: 0 to 2. Throws DataError for a line of half names and half
/// numbers, and for names that are not as many as the columns.
[[nodiscard]] std::size_t read_header(const TextLines& lines, const std::string& source,
                                      const ReadOptions& options, TextDialect& dialect);

/// How many lines of content stand before the names or, without names, before the first row: the head of a
/// LabVIEW measurement file, whose step (Delta_X) and units (Y_Unit_Label) go into `dialect`, and any other
/// lines that are no row. 0 where the first line may be names or a row.
[[nodiscard]] std::size_t find_preamble(const TextLines& lines, TextDialect& dialect);

/// The head of a TwinCAT Scope export: lines of a key and what it says of each channel, "Name" over the
/// times. Which lines there are, what separates cells, how decimals are marked and which channels share a
/// column of times are options of the export
/// (https://infosys.beckhoff.com/content/1033/te13xx_tc3_scopeview/6193063051.html). What it says, with the
/// delimiter and head_lines, which are all lines above the first row; none where the lines do not begin as
/// such an export does. Throws DataError, which begins with `source`, for exports that cannot be read: cells
/// and decimals with the same mark, channels of several rates without times.
[[nodiscard]] std::optional<TextDialect> scope_header(const TextLines& lines, const std::string& source);

/// Without the carriage return of a line end of two bytes.
[[nodiscard]] inline std::string_view line_content(std::string_view line) {
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    return line;
}

// Rows of the opening of a text log, for what they say about units.

/// All whole lines of `bytes`, which begin with the first row. Rows that are none are left out. Without a
/// time column, time counts the rows.
[[nodiscard]] MotionSample text_motion_sample(std::string_view bytes, const TextDialect& dialect,
                                              const Layout& layout, const std::vector<std::size_t>& columns);

}  // namespace ripplenotch
