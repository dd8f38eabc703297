// SPDX-License-Identifier: MIT
#pragma once
// A comparison as people read it.

#include <string>

#include "ripplenotch/evaluate/comparison.hpp"

namespace ripplenotch {

/// The verdict, one row a method, and what was measured on what. Columns that nothing fills are left out.
[[nodiscard]] std::string comparison_view(const Comparison& comparison);

}  // namespace ripplenotch
