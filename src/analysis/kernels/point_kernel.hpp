// SPDX-License-Identifier: MIT
#pragma once
// One Fourier sum and its derivatives over an even grid, many samples at a time.

#include <span>

#include "ripplenotch/analysis/fourier.hpp"

namespace ripplenotch {

/// Sums of value[j] place^d exp(-2 pi i frequency place) for d = 0, 1, 2 with place = where[j] - middle; its
/// phase is taken as that of the grid with `step`.
[[nodiscard]] FourierPoint even_point(std::span<const double> where, std::span<const double> value,
                                      double middle, double step, double frequency);

}  // namespace ripplenotch
