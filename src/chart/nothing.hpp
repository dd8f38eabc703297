// SPDX-License-Identifier: MIT
#pragma once
#include <limits>

namespace ripplenotch {

/// Where a curve has a hole, a map an empty cell.
inline constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

}  // namespace ripplenotch
