// SPDX-License-Identifier: MIT
#include "analysis/kernels/spreading_kernel.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/vectors/lanes.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

using Row = SpreadingKernel::Row;
constexpr std::size_t terms = SpreadingKernel::terms;

/// Modified Bessel function of the first kind and order 0 of sqrt(square), by its power series.
double bessel_i0(double square) {
    double sum = 1.0, term = 1.0;
    for (double k = 1.0; term > 1e-17 * sum; k += 1.0) {
        term *= 0.25 * square / (k * k);
        sum += term;
    }
    return sum;
}

const double peak_of_kernel = bessel_i0(SpreadingKernel::beta * SpreadingKernel::beta);

constexpr std::size_t lanes = lane_count, groups = SpreadingKernel::padded / lanes;

/// Even and odd powers apart, so that half as many steps wait for each other.
template <class Lanes>
RIPPLENOTCH_INLINED void weigh(const Row* coefficients, double offset, Lanes (&row)[groups]) {
    const double z = 2.0 * offset - 1.0, square = z * z;
    Lanes even[groups], odd[groups], term;
#pragma GCC unroll 3
    for (std::size_t g = 0; g < groups; ++g) {
        load(even[g], &coefficients[terms - 2][g * lanes]);
        load(odd[g], &coefficients[terms - 1][g * lanes]);
    }
#pragma GCC unroll 7
    for (std::size_t d = terms - 2; d > 0; d -= 2) {
#pragma GCC unroll 3
        for (std::size_t g = 0; g < groups; ++g) {
            load(term, &coefficients[d - 2][g * lanes]);
            even[g] = even[g] * square + term;
            load(term, &coefficients[d - 1][g * lanes]);
            odd[g] = odd[g] * square + term;
        }
    }
#pragma GCC unroll 3
    for (std::size_t g = 0; g < groups; ++g) row[g] = even[g] + odd[g] * z;
}

struct Weigh {
    template <class Lanes>
    RIPPLENOTCH_INLINED static void run(const Row* coefficients, double offset, double* row) {
        Lanes weights[groups];
        weigh(coefficients, offset, weights);
        for (std::size_t g = 0; g < groups; ++g) store(row + g * lanes, weights[g]);
    }
};

struct Spread {
    template <class Lanes>
    RIPPLENOTCH_INLINED static void run(const Row* coefficients, std::span<const double> where,
                                        std::span<const double> value, double spacing,
                                        std::span<double> grid) {
        const auto n = static_cast<double>(grid.size());
        const double half = 0.5 * static_cast<double>(SpreadingKernel::width);
        Lanes weights[groups], cells;
        for (std::size_t j = 0; j < where.size(); ++j) {
            const double turns = where[j] * spacing;
            const double at = (turns - std::floor(turns)) * n;  // 0 <= at <= n
            const double first = std::ceil(at - half);
            weigh(coefficients, first - (at - half), weights);
            auto cell = static_cast<std::size_t>(first < 0.0 ? first + n : first);
            if (cell + SpreadingKernel::padded <= grid.size()) {
#pragma GCC unroll 3
                for (std::size_t g = 0; g < groups; ++g) {
                    double* const here = grid.data() + cell + g * lanes;
                    load(cells, here);
                    cells += weights[g] * value[j];
                    store(here, cells);
                }
                continue;
            }
            Row row;
            for (std::size_t g = 0; g < groups; ++g) store(row.data() + g * lanes, weights[g]);
            for (std::size_t i = 0; i < SpreadingKernel::width; ++i, ++cell) {
                if (cell >= grid.size()) cell -= grid.size();
                grid[cell] += value[j] * row[i];
            }
        }
    }
};

}  // namespace

double SpreadingKernel::value(double x) {
    return bessel_i0(beta * beta * std::max(0.0, 1.0 - x * x)) / peak_of_kernel;
}

double SpreadingKernel::transform(double phase) {
    const double root = std::sqrt(beta * beta - phase * phase);
    return (portable::exp(root) - portable::exp(-root)) / (root * peak_of_kernel);
}

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
                sum += value(x) * portable::cos(static_cast<double>(m) * angle);
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

void SpreadingKernel::at(double offset, Row& row) const {
    in_lanes<Weigh>(coefficients_.data(), offset, row.data());
}

void SpreadingKernel::spread(std::span<const double> where, std::span<const double> value, double spacing,
                             std::span<double> grid) const {
    in_lanes<Spread>(coefficients_.data(), where, value, spacing, grid);
}

}  // namespace ripplenotch
