// SPDX-License-Identifier: MIT
#include "analysis/spectrum/spreading_kernel.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/functions/many_numbers.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t at_once = 64;  ///< samples, whose exponentials are worked out together

}  // namespace

void SpreadingKernel::spread(std::span<const double> where, std::span<const double> value, double spacing,
                             std::span<double> grid) {
    const auto n = static_cast<double>(grid.size());
    const double half = 0.5 * static_cast<double>(width);
    std::array<double, at_once * width> weights;
    std::array<std::size_t, at_once> cells;
    for (std::size_t begin = 0; begin < where.size(); begin += at_once) {
        const std::size_t count = std::min(at_once, where.size() - begin);
        for (std::size_t j = 0; j < count; ++j) {
            const double turns = where[begin + j] * spacing;
            const double place = (turns - std::floor(turns)) * n;  // 0 <= place <= n
            const double first = std::ceil(place - half);
            cells[j] = static_cast<std::size_t>(first < 0.0 ? first + n : first);
            for (std::size_t i = 0; i < width; ++i) {
                const double x = (first + static_cast<double>(i) - place) / half;
                weights[j * width + i] = beta * (std::sqrt(std::max(0.0, 1.0 - x * x)) - 1.0);
            }
        }
        portable::many_exp(std::span(weights).first(count * width));
        for (std::size_t j = 0; j < count; ++j) {
            const double* const weight = weights.data() + j * width;
            const double torque = value[begin + j];
            if (std::size_t cell = cells[j]; cell + width > grid.size()) {
                for (std::size_t i = 0; i < width; ++i, ++cell)
                    grid[cell >= grid.size() ? cell - grid.size() : cell] += torque * weight[i];
            } else {
                for (std::size_t i = 0; i < width; ++i) grid[cell + i] += torque * weight[i];
            }
        }
    }
}

}  // namespace ripplenotch
