// SPDX-License-Identifier: MIT
#include "diagnose/beside/ridge.hpp"

#include <cmath>

#include "diagnose/beside/dot.hpp"

namespace ripplenotch {
Ridge::Ridge(const std::vector<std::vector<double>>& columns, std::span<const double> deviation, double noise)
    : columns_(columns) {
    // Columns that are as good as one another share what they explain in place of dividing by nothing.
    constexpr double least_of_its_own = 1e-9;
    const std::size_t m = columns.size();
    triangle_.assign(m * m, 0.0);
    for (const auto& column : columns) {
        const double square = dot(column.data(), column.data(), column.size());
        scale_.push_back(square > 0.0 ? std::sqrt(square) : 1.0);
    }
    const auto at = [&](std::size_t r, std::size_t c) -> double& { return triangle_[r * m + c]; };
    for (std::size_t r = 0; r < m; ++r) {
        const double drawn = noise / (deviation[r] * scale_[r]);
        for (std::size_t c = 0; c <= r; ++c) {
            double sum =
                dot(columns[r].data(), columns[c].data(), columns[r].size()) / (scale_[r] * scale_[c]);
            if (c == r) sum += drawn * drawn + least_of_its_own;
            for (std::size_t i = 0; i < c; ++i) sum -= at(r, i) * at(c, i);
            at(r, c) = c == r ? std::sqrt(std::max(sum, least_of_its_own)) : sum / at(c, c);
        }
    }
}

std::vector<double> Ridge::solve(std::span<const double> target) const {
    const std::size_t m = columns_.size();
    std::vector<double> values;
    for (std::size_t r = 0; r < m; ++r) {
        double sum = dot(columns_[r].data(), target.data(), target.size()) / scale_[r];
        for (std::size_t i = 0; i < r; ++i) sum -= triangle_[r * m + i] * values[i];
        values.push_back(sum / triangle_[r * m + r]);
    }
    for (std::size_t r = m; r-- > 0;) {
        for (std::size_t i = r + 1; i < m; ++i) values[r] -= triangle_[i * m + r] * values[i];
        values[r] /= triangle_[r * m + r];
    }
    for (std::size_t r = 0; r < m; ++r) values[r] /= scale_[r];
    return values;
}

std::vector<double> Ridge::left(std::span<const double> target, const std::vector<double>& values) const {
    std::vector<double> rest(target.begin(), target.end());
    for (std::size_t r = 0; r < columns_.size(); ++r)
        add_scaled(-values[r], columns_[r].data(), rest.data(), rest.size());
    return rest;
}

std::vector<double> Ridge::left(std::span<const double> target) const { return left(target, solve(target)); }

}  // namespace ripplenotch
