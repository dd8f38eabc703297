// SPDX-License-Identifier: MIT
#include "diagnose/beside/weighing/ridge.hpp"

#include <cmath>

#include "core/vectors/dot.hpp"

namespace ripplenotch {

using Eigen::Index;

Ridge::Ridge(const std::vector<std::vector<double>>& columns, std::span<const double> deviation, double noise)
    : columns_(columns), scale_(static_cast<Index>(columns.size())) {
    // Columns that are as good as one another share what they explain in place of dividing by nothing.
    constexpr double least_of_its_own = 1e-9;
    const auto m = scale_.size();
    const auto product = [&](Index r, Index c) {
        const auto &one = columns[static_cast<std::size_t>(r)], &other = columns[static_cast<std::size_t>(c)];
        return dot(one.data(), other.data(), one.size());
    };
    for (Index r = 0; r < m; ++r) {
        const double square = product(r, r);
        scale_[r] = square > 0.0 ? std::sqrt(square) : 1.0;
    }
    Eigen::MatrixXd products(m, m);
    for (Index r = 0; r < m; ++r) {
        const double drawn = noise / (deviation[static_cast<std::size_t>(r)] * scale_[r]);
        for (Index c = 0; c <= r; ++c) products(r, c) = product(r, c) / (scale_[r] * scale_[c]);
        products(r, r) += drawn * drawn + least_of_its_own;
    }
    factored_ = DefiniteFactors(products);
}

std::vector<double> Ridge::solve(std::span<const double> target) const {
    Eigen::VectorXd values(scale_.size());
    for (Index r = 0; r < values.size(); ++r)
        values[r] =
            dot(columns_[static_cast<std::size_t>(r)].data(), target.data(), target.size()) / scale_[r];
    values = factored_.solve(values).cwiseQuotient(scale_);
    return {values.begin(), values.end()};
}

std::vector<double> Ridge::left(std::span<const double> target, const std::vector<double>& values) const {
    std::vector<double> rest(target.begin(), target.end());
    for (std::size_t r = 0; r < columns_.size(); ++r)
        add_scaled(-values[r], columns_[r].data(), rest.data(), rest.size());
    return rest;
}

std::vector<double> Ridge::left(std::span<const double> target) const { return left(target, solve(target)); }

}  // namespace ripplenotch
