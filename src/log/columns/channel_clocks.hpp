// SPDX-License-Identifier: MIT
#pragma once
// Tables in which each channel has a column of times beside it.

#include <string>

#include "log/columns/decide_layout.hpp"

namespace ripplenotch::layout_detail {

/// Throws DataError where a chosen column's own times are not those that were chosen, as far as the opening
/// shows: its rows would be moments of another clock.
void check_channel_clocks(const std::string& source, const ColumnFacts& facts, const Layout& layout);

}  // namespace ripplenotch::layout_detail
