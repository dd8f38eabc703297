// SPDX-License-Identifier: MIT
#include "diagnose/beside/weighing/ridge.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

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

std::vector<double> Ridge::values_of(Eigen::VectorXd products) const {
    products = products.cwiseQuotient(scale_).eval();
    products = factored_.solve(products).cwiseQuotient(scale_);
    return {products.begin(), products.end()};
}

std::vector<double> Ridge::solve(std::span<const double> target) const {
    Eigen::VectorXd products(scale_.size());
    for (Index r = 0; r < products.size(); ++r)
        products[r] = dot(columns_[static_cast<std::size_t>(r)].data(), target.data(), target.size());
    return values_of(std::move(products));
}

std::vector<double> Ridge::left(std::span<const double> target, const std::vector<double>& values) const {
    std::vector<double> rest(target.begin(), target.end());
    for (std::size_t r = 0; r < columns_.size(); ++r)
        add_scaled(-values[r], columns_[r].data(), rest.data(), rest.size());
    return rest;
}

std::vector<double> Ridge::left(std::span<const double> target) const { return left(target, solve(target)); }

std::vector<std::vector<double>> Ridge::left(std::vector<std::vector<double>> targets) const {
    std::size_t t = 0;
    for (; t + 1 < targets.size(); t += 2) leave(targets[t], targets[t + 1]);
    if (t < targets.size()) targets[t] = left(targets[t]);
    return targets;
}

// The columns are more than a cache holds, and are read for both at once.
void Ridge::leave(std::vector<double>& one, std::vector<double>& other) const {
    constexpr std::size_t rows_at_once = 1024;  // by hand: two targets stay in the nearest cache
    const std::size_t rows = one.size(), columns = columns_.size(), even = columns - columns % 2;
    Eigen::VectorXd products(scale_.size()), others(scale_.size());
    for (std::size_t r = 0; r < even; r += 2) {
        const auto place = static_cast<Index>(r);
        double sums[4] = {};
        add_dots({columns_[r].data(), columns_[r + 1].data()}, {one.data(), other.data()}, rows, sums);
        products[place] = sums[0];
        others[place] = sums[1];
        products[place + 1] = sums[2];
        others[place + 1] = sums[3];
    }
    if (even < columns) {
        products[scale_.size() - 1] = dot(columns_.back().data(), one.data(), rows);
        others[scale_.size() - 1] = dot(columns_.back().data(), other.data(), rows);
    }
    const std::vector<double> own = values_of(std::move(products)), its = values_of(std::move(others));
    for (std::size_t first = 0; first < rows; first += rows_at_once) {
        const std::size_t count = std::min(rows_at_once, rows - first);
        double *to = one.data() + first, *its_to = other.data() + first;
        for (std::size_t r = 0; r < even; r += 2)
            add_scaled_pair({-own[r], -its[r], -own[r + 1], -its[r + 1]},
                            {columns_[r].data() + first, columns_[r + 1].data() + first}, {to, its_to},
                            count);
        if (even == columns) continue;
        add_scaled(-own.back(), columns_.back().data() + first, to, count);
        add_scaled(-its.back(), columns_.back().data() + first, its_to, count);
    }
}

}  // namespace ripplenotch
