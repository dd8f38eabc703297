// SPDX-License-Identifier: MIT
#pragma once
// How the cells of a text log are separated and its decimals marked: the reading under which most lines are
// rows of equally many numbers.

#include <cstddef>
#include <string_view>
#include <vector>

#include "log/text/text_cells.hpp"
#include "log/text/text_lines.hpp"
#include "ripplenotch/log/layout.hpp"

namespace ripplenotch {

struct GuessedRules {
    CellRules rules;
    std::size_t columns = 0;  ///< cells in a row; 0 when no reading makes rows of it
    std::size_t numbers = 0;  ///< numeric cells in a row, on average, rounded up
};

/// `first` may be a header; `rows` are the lines compared. What `options` state is taken as stated.
[[nodiscard]] GuessedRules guess_rules(std::string_view bytes, const TextLine& first,
                                       const std::vector<TextLine>& rows, const ReadOptions& options);

}  // namespace ripplenotch
