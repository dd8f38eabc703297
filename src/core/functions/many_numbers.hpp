// SPDX-License-Identifier: MIT
#pragma once
// Exponentials, logarithms, powers and phasors of many numbers at once: the bits of
// ripplenotch/core/portable_math.hpp for each, several times faster. Further spans are as long as the first,
// or longer; exp, log, tanh and pow may write over what they read.

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

namespace ripplenotch::portable {

void exp(std::span<const double> x, std::span<double> value);
void log(std::span<const double> x, std::span<double> value);
void tanh(std::span<const double> x, std::span<double> value);
void pow(std::span<const double> x, double p, std::span<double> value);
/// Cosines and sines of angles in radians, those of phasor().
void phasors(std::span<const double> angle_rad, std::span<double> cosine, std::span<double> sine);

/// The cosines alone; both spans may be the same numbers.
void cos(std::span<const double> angle_rad, std::span<double> cosine);

/// Each number becomes its exponential, or its hyperbolic tangent.
inline void many_exp(std::span<double> numbers) { exp(numbers, numbers); }
inline void many_tanh(std::span<double> numbers) { tanh(numbers, numbers); }

}  // namespace ripplenotch::portable

namespace ripplenotch {

/// use(k, value of number(k)) for each sample k, in rooms that stay in the first cache. `many` makes values
/// of numbers in their place.
template <class Number, class Many, class Use>
void with_values(std::size_t samples, Number number, Many many, Use use) {
    std::array<double, 256> values{};
    for (std::size_t first = 0; first < samples; first += values.size()) {
        const std::span<double> now = std::span(values).first(std::min(values.size(), samples - first));
        for (std::size_t i = 0; i < now.size(); ++i) now[i] = number(first + i);
        many(now);
        for (std::size_t i = 0; i < now.size(); ++i) use(first + i, now[i]);
    }
}

/// The same with two numbers a sample: use(k, value of number(k), value of other(k)).
template <class Number, class Many, class Other, class ManyOthers, class Use>
void with_two_values(std::size_t samples, Number number, Many many, Other other, ManyOthers many_others,
                     Use use) {
    std::array<double, 256> values{}, others{};
    for (std::size_t first = 0; first < samples; first += values.size()) {
        const std::size_t count = std::min(values.size(), samples - first);
        for (std::size_t i = 0; i < count; ++i) values[i] = number(first + i);
        for (std::size_t i = 0; i < count; ++i) others[i] = other(first + i);
        many(std::span(values).first(count));
        many_others(std::span(others).first(count));
        for (std::size_t i = 0; i < count; ++i) use(first + i, values[i], others[i]);
    }
}

}  // namespace ripplenotch
