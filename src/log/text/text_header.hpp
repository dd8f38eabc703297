// SPDX-License-Identifier: MIT
#pragma once
// The names over the columns of a text log: a first line of words, a row of units under it, or the last
// comment before the numbers.

#include <cstddef>
#include <string>
#include <string_view>

#include "log/text/text_dialect.hpp"
#include "log/text/text_lines.hpp"

namespace ripplenotch {

/// True when the text holds a letter, of whatever alphabet.
[[nodiscard]] bool has_letters(std::string_view text);

/// Fills in the names, units and their places in `dialect`, whose rules and columns are known. Returns how
/// many lines of content the header takes: 0 to 2. Throws DataError for a line of half names and half
/// numbers, and for names that are not as many as the columns.
[[nodiscard]] std::size_t read_header(std::string_view bytes, const TextLines& lines,
                                      const std::string& source, const ReadOptions& options,
                                      TextDialect& dialect);

}  // namespace ripplenotch
