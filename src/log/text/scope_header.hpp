// SPDX-License-Identifier: MIT
#pragma once
// The head of a TwinCAT Scope export: lines of a key and what it says of each channel, "Name" over the times.
// Which lines there are, what separates cells, how decimals are marked and which channels share a column of
// times are options of the export
// (https://infosys.beckhoff.com/content/1033/te13xx_tc3_scopeview/6193063051.html).

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "log/columns/decide_layout.hpp"
#include "log/text/text_dialect.hpp"

namespace ripplenotch {

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
