// SPDX-License-Identifier: MIT
#include "diagnose/case/noise_columns.hpp"

#include <algorithm>
#include <cmath>

#include "core/matrices/factorisations.hpp"
#include "core/vectors/dot.hpp"

namespace ripplenotch {

void NoiseColumns::add(std::vector<double> column) {
    const double squares = dot(column.data(), column.data(), column.size());
    if (!(squares > 0.0) || !std::isfinite(squares)) return;
    const double scale = std::sqrt(static_cast<double>(column.size()) / squares);
    for (std::size_t k = 0; k < column.size(); ++k) column[k] = use_[k] != 0 ? scale * column[k] : 0.0;
    columns_.push_back(std::move(column));
}

void NoiseColumns::cut(std::size_t count) {
    columns_.resize(std::min(count, columns_.size()));
    products_.resize(std::min(count, products_.size()));
}

// Of the columns that are new since the last time, two by two.
void NoiseColumns::sum_products() {
    const std::size_t begin = products_.size(), end = columns_.size(), rows = use_.size();
    for (std::size_t i = begin; i < end; ++i) products_.emplace_back(i + 1, 0.0);
    for (std::size_t row = 0; row < rows; row += block_rows) {
        const std::size_t count = std::min(block_rows, rows - row);
        for (std::size_t i = begin; i < end; i += 2) {
            const std::size_t next = std::min(i + 1, end - 1);
            const double* const a[2] = {columns_[i].data() + row, columns_[next].data() + row};
            for (std::size_t j = 0; j <= next; j += 2) {
                const std::size_t after = std::min(j + 1, next);
                const double* const b[2] = {columns_[j].data() + row, columns_[after].data() + row};
                double sums[4] = {};
                add_dots(a, b, count, sums);
                if (j <= i) products_[i][j] += sums[0];
                if (j < after && after <= i) products_[i][after] += sums[1];
                if (next == i) continue;
                products_[next][j] += sums[2];
                if (j < after) products_[next][after] += sums[3];
            }
        }
    }
}

std::vector<double> NoiseColumns::left_of(std::span<const double> torque_nm) {
    sum_products();
    const std::size_t rows = use_.size();
    std::vector<double> left(torque_nm.begin(), torque_nm.end());
    for (std::size_t k = 0; k < rows; ++k) left[k] = use_[k] != 0 ? left[k] : 0.0;
    const auto n = static_cast<Eigen::Index>(columns_.size());
    Eigen::MatrixXd gram(n, n);
    Eigen::VectorXd target(n);
    for (std::size_t i = 0; i < columns_.size(); ++i) {
        const auto row = static_cast<Eigen::Index>(i);
        for (std::size_t j = 0; j <= i; ++j) gram(row, static_cast<Eigen::Index>(j)) = products_[i][j];
        gram(row, row) += 1e-7 * static_cast<double>(rows);
        target[row] = dot(columns_[i].data(), left.data(), rows);
    }
    const Eigen::VectorXd theta = SymmetricFactors(gram).solve(target);
    for (std::size_t row = 0; row < rows; row += block_rows) {
        const std::size_t count = std::min(block_rows, rows - row);
        for (std::size_t i = 0; i < columns_.size(); ++i) {
            add_scaled(-theta[static_cast<Eigen::Index>(i)], columns_[i].data() + row, left.data() + row,
                       count);
        }
    }
    return left;
}

}  // namespace ripplenotch
