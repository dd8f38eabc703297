// SPDX-License-Identifier: MIT
#include "diagnose/engine/gram.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/matrices/factorisations.hpp"
#include "core/vectors/dot.hpp"

namespace ripplenotch::engine {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

void extend_gram(MatrixXd& gram, std::span<const std::span<const double>> columns,
                 std::span<const unsigned char> use) {
    // Rows that count are copied in chunks that stay in the second cache with all columns.
    constexpr std::size_t chunk = 256;
    const std::size_t count = columns.size(), rows = use.size();
    const auto known = static_cast<std::size_t>(gram.rows());
    MatrixXd sums = MatrixXd::Zero(static_cast<Index>(count), static_cast<Index>(count));
    std::vector<double> packed(count * chunk);
    std::vector<std::size_t> rows_now, active;
    for (std::size_t row = 0; row < rows;) {
        rows_now.clear();
        for (; row < rows && rows_now.size() < chunk; ++row)
            if (use[row] != 0) rows_now.push_back(row);
        active.clear();
        for (std::size_t c = 0; c < count; ++c) {
            double* to = &packed[active.size() * chunk];
            const double* from = columns[c].data();
            bool any = false;
            for (std::size_t i = 0; i < rows_now.size(); ++i) {
                to[i] = from[rows_now[i]];
                any = any || to[i] != 0.0;
            }
            if (any) active.push_back(c);
        }
        const std::size_t used = active.size();
        for (std::size_t a = 0; a < used; a += 2) {
            const std::size_t a1 = std::min(a + 1, used - 1);
            if (active[a1] < known) continue;
            for (std::size_t b = 0; b <= a; b += 2) {
                const std::size_t b1 = std::min(b + 1, used - 1);
                double four[4] = {0.0, 0.0, 0.0, 0.0};
                add_dots({&packed[a * chunk], &packed[a1 * chunk]}, {&packed[b * chunk], &packed[b1 * chunk]},
                         rows_now.size(), four);
                const auto add = [&](std::size_t i, std::size_t j, double value) {
                    sums(static_cast<Index>(active[i]), static_cast<Index>(active[j])) += value;
                };
                add(a, b, four[0]);
                if (b1 != b && b1 <= a) add(a, b1, four[1]);
                if (a1 != a) add(a1, b, four[2]);
                if (a1 != a && b1 != b) add(a1, b1, four[3]);
            }
        }
    }
    sums.topLeftCorner(gram.rows(), gram.cols()) = gram;
    gram = sums.selfadjointView<Eigen::Lower>();
}

VectorXd solve_normal_equations(const MatrixXd& gram, std::span<const double> extra) {
    const Index count = gram.rows() - 1;
    if (count == 0) return {};
    // A column of zeros gets a factor of 0.
    const VectorXd scale = gram.diagonal().tail(count).cwiseMax(1e-200).cwiseSqrt();
    MatrixXd scaled = gram.bottomRightCorner(count, count);
    for (Index i = 0; i < count; ++i)
        for (Index j = 0; j < count; ++j) scaled(i, j) /= scale[i] * scale[j];
    for (Index i = 0; i < count; ++i)
        scaled(i, i) += extra.empty() ? ridge : extra[static_cast<std::size_t>(i)];
    const VectorXd right = gram.col(0).tail(count).cwiseQuotient(scale);
    return SymmetricFactors(scaled).solve(right).cwiseQuotient(scale);
}

std::vector<double> regress(const std::vector<std::vector<double>>& columns,
                            const std::vector<double>& target, std::span<const unsigned char> use) {
    std::vector<std::span<const double>> with_target = {target};
    with_target.insert(with_target.end(), columns.begin(), columns.end());
    MatrixXd gram;
    extend_gram(gram, with_target, use);
    const VectorXd found = solve_normal_equations(gram);
    return {found.data(), found.data() + found.size()};
}

}  // namespace ripplenotch::engine
