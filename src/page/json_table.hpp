// SPDX-License-Identifier: MIT
#pragma once
// A list of objects as a table of a page.

#include <string>

#include "document/json/json.hpp"
#include "ripplenotch/page/page.hpp"

namespace ripplenotch {

/// A list of objects, not empty.
[[nodiscard]] bool is_table(const Json& json);

/// One row an object, one column a field, units apart; objects and short lists within a row are columns of
/// their own, and columns that no row fills are left out. At most 200 rows; the title says how many there
/// are.
[[nodiscard]] PageTable table_of(const std::string& name, const Json& rows);

}  // namespace ripplenotch
