// SPDX-License-Identifier: MIT
#pragma once
// Tables for people: columns as wide as their widest cell, two spaces between them.

#include <string>
#include <string_view>
#include <vector>

namespace ripplenotch {

/// Rows of cells, header rows included. `alignment` has one letter a column, 'l' or 'r'; the last letter
/// holds for all further columns. Cells are made visible. Rows may be of different length; no line ends in a
/// space.
[[nodiscard]] std::string text_table(const std::vector<std::vector<std::string>>& cells,
                                     std::string_view alignment);

}  // namespace ripplenotch
