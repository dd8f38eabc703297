// SPDX-License-Identifier: MIT
#pragma once
// The inner loops over one evenly sampled piece of a log. Sums run side by side and are put together in
// one order.

#include <array>
#include <complex>
#include <cstddef>
#include <span>

namespace ripplenotch {

/// What one look at a part of an evenly sampled piece tells, its two columns side by side: reading them is
/// what it costs.
struct EvenPart {
    double worst = 0.0;  ///< largest distance of a time from its place, in the unit of time
    double sum = 0.0;
    double tilt = 0.0;  ///< sum of the values times their distance from the part's middle, in samples
    std::size_t count = 0;
};
/// Of the samples from `from` on; the even grid begins with time[0] and has steps of `step`.
[[nodiscard]] EvenPart look_at_even(std::span<const double> time, std::span<const double> values, double step,
                                    std::size_t from = 0);
/// Two parts, one behind the other, as one.
[[nodiscard]] EvenPart together(const EvenPart& early, const EvenPart& late);

/// Straight line through values at 0, 1, 2, ... by least squares: mean + slope * (k - (n - 1) / 2).
struct EvenLine {
    double mean = 0.0, slope = 0.0;
};
[[nodiscard]] EvenLine even_line(const EvenPart& values);

/// to[k] = (values[k] - line at k) * window[k].
void subtract_line_and_window(std::span<const double> values, const EvenLine& line,
                              std::span<const double> window, std::span<double> to);

/// sum over k of value[k] place[k]^d (cosine[k] + i sine[k]) for d = 0 .. 7.
using Moments = std::array<std::complex<double>, 8>;
[[nodiscard]] Moments turned_moments(std::span<const double> value, std::span<const double> place,
                                     std::span<const double> cosine, std::span<const double> sine);

}  // namespace ripplenotch
