// SPDX-License-Identifier: MIT
#pragma once
// The kernel by which nonuniform_fourier puts samples on a grid: that of Kaiser and Bessel, I0(beta sqrt(1 -
// x^2)) / I0(beta) over |x| <= 1, `width` points wide on a grid twice as fine as needed.

#include <array>
#include <cstddef>
#include <span>

namespace ripplenotch {

struct SpreadingKernel {
    static constexpr std::size_t width = 10;
    static constexpr double beta = 2.30 * static_cast<double>(width);
    static constexpr std::size_t padded = 12;  ///< the points of the kernel, filled up to whole vectors
    static constexpr std::size_t terms = 16;   ///< terms of a polynomial
    using Row = std::array<double, padded>;

    /// Works the polynomials out; once a program.
    SpreadingKernel();

    /// The kernel at -1 to 1.
    [[nodiscard]] static double value(double x);
    /// Its integral times exp(i phase x), for |phase| < beta.
    [[nodiscard]] static double transform(double phase);

    /// The kernel at all its points, the first of which lies `offset` grid steps, 0 to 1, inside of its left
    /// end. Each point has a polynomial in the offset, within 1e-12 of the kernel's peak.
    void at(double offset, Row& row) const;
    /// Adds each value to the points of a grid around its place, weighted by the kernel. The grid goes
    /// around: `spacing` times a place is turns of it. At least `padded` points.
    void spread(std::span<const double> where, std::span<const double> value, double spacing,
                std::span<double> grid) const;

  private:
    std::array<Row, terms> coefficients_{};  // by power of 2 offset - 1
};

}  // namespace ripplenotch
