// SPDX-License-Identifier: MIT
#pragma once
// The inner loops over one evenly sampled piece of a log. Sums run side by side and are put together in
// one order, so that the bits are the same whether or not the processor has AVX2.

#include <array>
#include <complex>
#include <cstddef>
#include <span>

namespace ripplenotch {

/// Largest distance of time[from] and those after it from an even grid that begins with time[0], in the unit
/// of time.
[[nodiscard]] double off_even_grid(std::span<const double> time, double step, std::size_t from = 0);

/// Straight line through values at 0, 1, 2, ... by least squares: mean + slope * (k - (n - 1) / 2).
struct EvenLine {
    double mean = 0.0, slope = 0.0;
};
[[nodiscard]] EvenLine even_line(std::span<const double> values);

/// to[k] = (values[k] - line at k) * window[k].
void take_line_and_window(std::span<const double> values, const EvenLine& line,
                          std::span<const double> window, std::span<double> to);

/// power[k] += scale * |sums[k]|^2.
void add_power(std::span<const std::complex<double>> sums, double scale, std::span<double> power);

/// sum over k of value[k] place[k]^d (cosine[k] + i sine[k]) for d = 0 .. 7.
using Moments = std::array<std::complex<double>, 8>;
[[nodiscard]] Moments turned_moments(std::span<const double> value, std::span<const double> place,
                                     std::span<const double> cosine, std::span<const double> sine);

}  // namespace ripplenotch
