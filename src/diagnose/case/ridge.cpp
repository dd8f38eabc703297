// SPDX-License-Identifier: MIT
#include "diagnose/case/ridge.hpp"

#include <cmath>

#include "core/vectors/dot.hpp"

namespace ripplenotch {

using Eigen::Index;

Ridge::Ridge(const std::vector<std::vector<double>>& columns, std::span<const double> deviation, double noise)
    : columns_(columns), noise_(noise), scale_(static_cast<Index>(columns.size())) {
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
    Eigen::VectorXd products(scale_.size());
    for (Index r = 0; r < products.size(); ++r)
        products[r] =
            dot(columns_[static_cast<std::size_t>(r)].data(), target.data(), target.size()) / scale_[r];
    const Eigen::VectorXd values = factored_.solve(products).cwiseQuotient(scale_);
    return {values.begin(), values.end()};
}

std::vector<double> Ridge::standard_errors() const {
    const Index m = scale_.size();
    const Eigen::MatrixXd inverse = factored_.solve(Eigen::MatrixXd(Eigen::MatrixXd::Identity(m, m)));
    std::vector<double> errors;
    for (Index r = 0; r < m; ++r) errors.push_back(noise_ * std::sqrt(inverse(r, r)) / scale_[r]);
    return errors;
}

}  // namespace ripplenotch
