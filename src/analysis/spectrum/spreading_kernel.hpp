// SPDX-License-Identifier: MIT
#pragma once
// The kernel by which nonuniform_fourier puts samples on a grid: exp(beta (sqrt(1 - x^2) - 1)) over |x| <= 1,
// `width` points wide on a grid twice as fine as needed.

#include <cstddef>
#include <span>

namespace ripplenotch {

struct SpreadingKernel {
    static constexpr std::size_t width = 10;  ///< by hand: sums within 1e-9 of the magnitudes
    static constexpr double beta = 2.30 * static_cast<double>(width);  ///< as Barnett and others choose it

    /// Adds each value to the points of a grid around its place, weighted by the kernel. The grid goes
    /// around: `spacing` times a place is turns of it. At least `width` points.
    static void spread(std::span<const double> where, std::span<const double> value, double spacing,
                       std::span<double> grid);
};

}  // namespace ripplenotch
