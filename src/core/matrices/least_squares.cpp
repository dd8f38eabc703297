// SPDX-License-Identifier: MIT
#include "core/matrices/least_squares.hpp"

#include "core/matrices/factorisations.hpp"
#include "core/vectors/dot.hpp"

namespace ripplenotch {

std::vector<double> least_squares(const std::vector<std::vector<double>>& columns,
                                  std::span<const double> target) {
    const auto count = static_cast<Eigen::Index>(columns.size());
    Eigen::MatrixXd products(count, count);
    Eigen::VectorXd side(count);
    for (Eigen::Index i = 0; i < count; ++i) {
        const double* const column = columns[static_cast<std::size_t>(i)].data();
        for (Eigen::Index j = 0; j <= i; ++j)
            products(i, j) = products(j, i) =
                dot(column, columns[static_cast<std::size_t>(j)].data(), target.size());
        side(i) = dot(column, target.data(), target.size());
    }
    const Eigen::VectorXd values = RankedFactors(products).solve(side);
    return {values.begin(), values.end()};
}

}  // namespace ripplenotch
