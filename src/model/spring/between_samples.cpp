// SPDX-License-Identifier: MIT
#include "model/spring/between_samples.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/vectors/dot.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

// Value at a place of the signal that goes on as its ends.
double at(std::span<const double> values, std::ptrdiff_t place) {
    const auto last = static_cast<std::ptrdiff_t>(values.size()) - 1;
    return values[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(place, 0, last))];
}

constexpr int shift_points = 16;  // by hand
constexpr int lag_points = step_points;

// Weights of the samples at -(count / 2 - 1), ..., count / 2 for the value at u in [0, 1).
template <int count>
std::array<double, count> lagrange_weights(double u) {
    std::array<double, count> weights{};
    for (int i = 0; i < count; ++i) {
        double weight = 1.0;
        for (int j = 0; j < count; ++j) {
            if (j != i) weight *= (u - (j - count / 2 + 1)) / static_cast<double>(i - j);
        }
        weights[static_cast<std::size_t>(i)] = weight;
    }
    return weights;
}

// integral from 0 to 1 of u^m rate exp(-(1 - u) rate), m = 0 ... lag_points - 1. Partial integration ties
// neighbours together: I(m) = 1 - m / rate * I(m - 1). Upwards it is stable for a large rate, downwards for a
// small one.
std::array<double, lag_points> moments(double rate) {
    std::array<double, lag_points> found{};
    if (rate > lag_points) {
        found[0] = 1.0 - portable::exp(-std::min(rate, 700.0));
        for (int m = 1; m < lag_points; ++m)
            found[static_cast<std::size_t>(m)] = 1.0 - m / rate * found[static_cast<std::size_t>(m - 1)];
        return found;
    }
    constexpr int far = 60;  // by hand: where the recurrence begins
    double moment = rate / (far + 1.0);
    for (int m = far; m > 0; --m) {
        moment = (1.0 - moment) * rate / m;
        if (m <= lag_points) found[static_cast<std::size_t>(m - 1)] = moment;
    }
    return found;
}

// Coefficients of u^0, u^1, ... of the polynomial that is 1 at sample i and 0 at the others.
std::array<double, lag_points> lagrange_coefficients(int i) {
    std::array<double, lag_points> coefficients{1.0};
    for (int j = 0; j < lag_points; ++j) {
        if (j == i) continue;
        const double zero = j - lag_points / 2 + 1, scale = i - j;
        for (std::size_t m = lag_points - 1; m > 0; --m)
            coefficients[m] = (coefficients[m - 1] - zero * coefficients[m]) / scale;
        coefficients[0] = -zero * coefficients[0] / scale;
    }
    return coefficients;
}

// values[k] becomes the sum of weights[i] * before[k + first + i], in this order, for every k.
void weigh_neighbours(std::span<const double> before, std::span<const double> weights, std::ptrdiff_t first,
                      std::span<double> values) {
    const auto n = static_cast<std::ptrdiff_t>(before.size()),
               points = static_cast<std::ptrdiff_t>(weights.size());
    // Where all points are samples, point after point for many samples at once: the same sums.
    const std::ptrdiff_t begin = std::clamp<std::ptrdiff_t>(-first, 0, n),
                         end = std::clamp<std::ptrdiff_t>(n - first - points + 1, begin, n);
    const auto by_itself = [&](std::ptrdiff_t k) {
        double sum = 0.0;
        for (std::ptrdiff_t i = 0; i < points; ++i)
            sum += weights[static_cast<std::size_t>(i)] * at(before, k + first + i);
        values[static_cast<std::size_t>(k)] = sum;
    };
    for (std::ptrdiff_t k = 0; k < begin; ++k) by_itself(k);
    constexpr std::ptrdiff_t block = 512;
    for (std::ptrdiff_t k = begin; k < end; k += block) {
        const auto count = static_cast<std::size_t>(std::min(block, end - k));
        std::fill_n(values.data() + k, count, 0.0);
        for (std::ptrdiff_t i = 0; i < points; ++i) {
            add_scaled(weights[static_cast<std::size_t>(i)], before.data() + k + first + i, values.data() + k,
                       count);
        }
    }
    for (std::ptrdiff_t k = end; k < n; ++k) by_itself(k);
}

}  // namespace

void shift_samples(std::span<double> values, double delay) {
    if (values.empty()) return;
    const double whole = std::ceil(delay);
    const auto weights = lagrange_weights<shift_points>(whole - delay);
    const std::vector<double> before(values.begin(), values.end());
    weigh_neighbours(before, weights, -static_cast<std::ptrdiff_t>(whole) - (shift_points / 2 - 1), values);
}

StepWeights step_weights(const std::array<double, step_points>& moments) {
    StepWeights weights{};
    for (int i = 0; i < step_points; ++i) {
        const auto coefficients = lagrange_coefficients(i);
        for (std::size_t m = 0; m < step_points; ++m)
            weights[static_cast<std::size_t>(i)] += coefficients[m] * moments[m];
    }
    return weights;
}

std::vector<double> over_steps(std::span<const double> values, const StepWeights& weights) {
    std::vector<double> found(values.size());
    // From sample k - 1 (u = 0) to sample k (u = 1).
    weigh_neighbours(values, weights, -1 - (step_points / 2 - 1), found);
    return found;
}

void first_order_lag(std::span<double> values, double time_constant) {
    if (values.empty()) return;
    const double rate = 1.0 / time_constant;
    const StepWeights weights = step_weights(moments(rate));
    const double kept = portable::exp(-std::min(rate, 700.0));
    const std::vector<double> before(values.begin(), values.end());
    // From sample k - 1 (u = 0) to sample k (u = 1).
    weigh_neighbours(before, weights, -1 - (lag_points / 2 - 1), values);
    values[0] = before[0];
    for (std::size_t k = 1; k < values.size(); ++k) values[k] += kept * values[k - 1];
}

}  // namespace ripplenotch
