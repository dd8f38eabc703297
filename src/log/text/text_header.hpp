// SPDX-License-Identifier: MIT
#pragma once
// The names over the columns of a text log: a first line of words, a row of units under it, or the last
// comment before the numbers.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

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

}  // namespace ripplenotch
