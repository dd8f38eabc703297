// SPDX-License-Identifier: MIT
#pragma once
// Where lines that are tracked together can be told apart: from the trend, and from each other.

#include <cstddef>
#include <vector>

namespace ripplenotch {

/// Per line and point: true where it cannot be told from the trend or from another line. `cycles`: turns of
/// each line at the points of one grid, at least `width` + 1 of them. `width`: points in 1/bandwidth.
/// `fewest`: cycles of a line within them, below which it is one with the trend or its own mirror image.
[[nodiscard]] std::vector<std::vector<bool>> not_separable(const std::vector<std::vector<double>>& cycles,
                                                           std::size_t width, double fewest);

}  // namespace ripplenotch
