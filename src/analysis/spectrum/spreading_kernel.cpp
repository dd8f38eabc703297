// SPDX-License-Identifier: MIT
#include "analysis/spectrum/spreading_kernel.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t terms = SpreadingKernel::terms;

double kernel(double x) {
    return portable::exp(SpreadingKernel::beta * (std::sqrt(std::max(0.0, 1.0 - x * x)) - 1.0));
}

}  // namespace

SpreadingKernel::SpreadingKernel() {
    // Chebyshev's interpolation: c_m = 2/n sum f(z_j) T_m(z_j), and T_m by powers from T_m+1 = 2 z T_m -
    // T_m-1.
    std::array<double, terms> before{}, now{};
    now[0] = 1.0;
    for (std::size_t m = 0; m < terms; ++m) {
        for (std::size_t i = 0; i < width; ++i) {
            double sum = 0.0;
            for (std::size_t j = 0; j < terms; ++j) {
                const double angle = std::numbers::pi * (static_cast<double>(j) + 0.5) / terms;
                const double offset = 0.5 * (portable::cos(angle) + 1.0);
                const double x = (static_cast<double>(i) + offset) * 2.0 / width - 1.0;
                sum += kernel(x) * portable::cos(static_cast<double>(m) * angle);
            }
            const double share = (m == 0 ? 1.0 : 2.0) / terms * sum;
            for (std::size_t d = 0; d <= m; ++d) coefficients_[d][i] += share * now[d];
        }
        std::array<double, terms> next{};
        for (std::size_t d = 0; d < terms; ++d) {
            next[d] = -before[d];
            if (d > 0) next[d] += (m == 0 ? 1.0 : 2.0) * now[d - 1];
        }
        before = now;
        now = next;
    }
}

// Even and odd powers apart, so that half as many steps wait for each other.
void SpreadingKernel::at(double offset, Row& row) const {
    const double z = 2.0 * offset - 1.0, square = z * z;
    Row even = coefficients_[terms - 2], odd = coefficients_[terms - 1];
    for (std::size_t d = terms - 2; d > 0; d -= 2) {
        for (std::size_t i = 0; i < padded; ++i) even[i] = even[i] * square + coefficients_[d - 2][i];
        for (std::size_t i = 0; i < padded; ++i) odd[i] = odd[i] * square + coefficients_[d - 1][i];
    }
    for (std::size_t i = 0; i < padded; ++i) row[i] = even[i] + odd[i] * z;
}

void SpreadingKernel::spread(std::span<const double> where, std::span<const double> value, double spacing,
                             std::span<double> grid) const {
    const auto n = static_cast<double>(grid.size());
    const double half = 0.5 * static_cast<double>(width);
    Row row;
    for (std::size_t j = 0; j < where.size(); ++j) {
        const double turns = where[j] * spacing;
        const double place = (turns - std::floor(turns)) * n;  // 0 <= place <= n
        const double first = std::ceil(place - half);
        at(first - (place - half), row);
        auto cell = static_cast<std::size_t>(first < 0.0 ? first + n : first);
        if (cell + padded <= grid.size()) {
            for (std::size_t i = 0; i < padded; ++i) grid[cell + i] += row[i] * value[j];
            continue;
        }
        for (std::size_t i = 0; i < width; ++i, ++cell) {
            if (cell >= grid.size()) cell -= grid.size();
            grid[cell] += value[j] * row[i];
        }
    }
}

}  // namespace ripplenotch
