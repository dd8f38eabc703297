// SPDX-License-Identifier: MIT
#pragma once
// The names over the columns of a text log: a first line of words, a row of units under it, or the last
// comment before the numbers.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "log/columns/decide_layout.hpp"
#include "log/text/text_cells.hpp"
#include "log/text/text_dialect.hpp"

namespace ripplenotch {

/// True when the text holds a letter, of whatever alphabet.
[[nodiscard]] bool has_letters(std::string_view text);

/// Fills in the names, units and their places in `dialect`, whose rules and columns are known. Returns how
/// many lines of content the header takes: 0 to 2. Throws DataError for a line of half names and half
/// numbers, and for names that are not as many as the columns.
[[nodiscard]] std::size_t read_header(std::string_view bytes, const TextLines& lines,
                                      const std::string& source, const ReadOptions& options,
                                      TextDialect& dialect);

// What some programs write above a table: the head of a LabVIEW measurement file, and any other lines that
// are no row of it.

struct Preamble {
    std::size_t lines = 0;  ///< of content, before the names or, without names, the first row
    std::size_t first_row = 0;
    /// Seconds from row to row where the head says them (LabVIEW's Delta_X), alike for all channels.
    std::optional<double> row_step_s;
    std::vector<std::string> units;  ///< by column, where the head says them (LabVIEW's Y_Unit_Label)
};

/// `content` with rows of `columns` cells somewhere below. None where the first line may be names or a row.
[[nodiscard]] Preamble find_preamble(std::string_view bytes, const std::vector<TextLine>& content,
                                     const CellRules& rules, std::size_t columns);

// The head of a TwinCAT Scope export: lines of a key and what it says of each channel, "Name" over the times.
// Which lines there are, what separates cells, how decimals are marked and which channels share a column of
// times are options of the export
// (https://infosys.beckhoff.com/content/1033/te13xx_tc3_scopeview/6193063051.html).

struct ScopeHeader {
    char delimiter = '\t';
    std::size_t names_line = 0, first_row = 0;  ///< of the lines of content
    /// By column; those of times have no name but the first.
    std::vector<std::string> names, units;
    std::vector<std::size_t> clock_of;  ///< where a column's times stand; empty in an export without times
    std::vector<HeadScale> scales;      ///< by column
    std::optional<double> row_step_s;   ///< of an export without times
};

/// None where `content`, the lines of `bytes`, does not begin as such an export does. Throws DataError, which
/// begins with `source`, for exports that cannot be read: cells and decimals with the same mark, channels of
/// several rates without times.
[[nodiscard]] std::optional<ScopeHeader> scope_header(std::string_view bytes,
                                                      const std::vector<TextLine>& content,
                                                      const std::string& source);

}  // namespace ripplenotch
