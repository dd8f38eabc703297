// SPDX-License-Identifier: MIT
#pragma once
// Least squares of a few columns.

#include <span>
#include <vector>

namespace ripplenotch {

/// The values by which the columns, all as long as `target`, are nearest to it. Where columns cannot be told
/// apart, or are 0, the smallest such values. By normal equations: for columns that are no near copies.
[[nodiscard]] std::vector<double> least_squares(const std::vector<std::vector<double>>& columns,
                                                std::span<const double> target);

}  // namespace ripplenotch
