// SPDX-License-Identifier: MIT
#include "diagnose/case/ridge.hpp"

#include <cmath>

#include "core/vectors/dot.hpp"

namespace ripplenotch {

using Eigen::Index;

Ridge::Ridge(const std::vector<std::vector<double>>& columns, std::span<const double> deviation, double noise)
    : columns_(columns), noise_(noise) {
    // Columns that are as good as one another share what they explain in place of dividing by nothing.
    constexpr double least_of_its_own = 1e-9;
    Eigen::MatrixXd products(static_cast<Index>(columns.size()), static_cast<Index>(columns.size()));
    for (std::size_t r = 0; r < columns.size(); ++r) {
        for (std::size_t c = 0; c <= r; ++c) {
            const double product = dot(columns[r].data(), columns[c].data(), columns[r].size());
            products(static_cast<Index>(r), static_cast<Index>(c)) = product;
            products(static_cast<Index>(c), static_cast<Index>(r)) = product;
        }
        const double prior = noise / deviation[r];
        products(static_cast<Index>(r), static_cast<Index>(r)) += prior * prior;
    }
    factored_ = ScaledDefiniteFactors(std::move(products), least_of_its_own);
}

std::vector<double> Ridge::solve(std::span<const double> target) const {
    Eigen::VectorXd products(static_cast<Index>(columns_.size()));
    for (std::size_t r = 0; r < columns_.size(); ++r)
        products[static_cast<Index>(r)] = dot(columns_[r].data(), target.data(), target.size());
    const Eigen::VectorXd values = factored_.solve(products);
    return {values.begin(), values.end()};
}

std::vector<double> Ridge::standard_errors() const {
    const Eigen::VectorXd errors = noise_ * factored_.inverse_diagonal().cwiseSqrt();
    return {errors.begin(), errors.end()};
}

}  // namespace ripplenotch
