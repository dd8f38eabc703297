// SPDX-License-Identifier: MIT
#include "diagnose/setup/blocks.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/matrices/factorisations.hpp"

namespace ripplenotch {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Columns may be combinations of each other (a joint that moves one way only): a pull towards 0 of a
// billionth of a column's own squares.
VectorXd solve_squares(const MatrixXd& products, const VectorXd& side) {
    VectorXd scale = products.diagonal();
    for (double& each : scale) each = each > 0.0 ? 1.0 / std::sqrt(each) : 0.0;
    MatrixXd scaled = scale.asDiagonal() * products * scale.asDiagonal();
    for (Index k = 0; k < scaled.rows(); ++k) scaled(k, k) += scale[k] > 0.0 ? 1e-9 : 1.0;
    return scale.cwiseProduct(SymmetricFactors(scaled).solve(VectorXd(scale.cwiseProduct(side))));
}

}  // namespace

double BlockedSquares::Sums::left(const VectorXd& values) const {
    return std::max(squares - 2.0 * values.dot(side) + values.dot(products * values), 0.0);
}

BlockedSquares::BlockedSquares(const std::vector<std::vector<double>>& columns,
                               std::span<const double> target, std::span<const std::size_t> block) {
    const auto count = static_cast<Index>(columns.size());
    const std::size_t blocks = block.empty() ? 0 : *std::max_element(block.begin(), block.end()) + 1;
    sums_.assign(blocks, {MatrixXd::Zero(count, count), VectorXd::Zero(count), 0.0});
    VectorXd row(count);
    for (std::size_t k = 0; k < target.size(); ++k) {
        for (Index c = 0; c < count; ++c) row[c] = columns[static_cast<std::size_t>(c)][k];
        Sums& sums = sums_[block[k]];
        sums.products += row * row.transpose();
        sums.side += target[k] * row;
        sums.squares += target[k] * target[k];
    }
    Sums all{MatrixXd::Zero(count, count), VectorXd::Zero(count), 0.0};
    for (const Sums& sums : sums_) {
        all.products += sums.products;
        all.side += sums.side;
    }
    values_ = solve_squares(all.products, all.side);
    for (const Sums& sums : sums_)
        without_.push_back(solve_squares(all.products - sums.products, all.side - sums.side));
}

double BlockedSquares::jackknife_error(std::size_t value) const {
    const auto at = static_cast<Index>(value);
    const auto count = static_cast<double>(without_.size());
    double mean = 0.0, squares = 0.0;
    for (const VectorXd& values : without_) mean += values[at] / count;
    for (const VectorXd& values : without_) squares += (values[at] - mean) * (values[at] - mean);
    return std::sqrt(squares * (count - 1.0) / count);
}

std::vector<double> BlockedSquares::held_out() const {
    std::vector<double> squares;
    for (std::size_t b = 0; b < sums_.size(); ++b) squares.push_back(sums_[b].left(without_[b]));
    return squares;
}

std::vector<double> BlockedSquares::left() const {
    std::vector<double> squares;
    for (const Sums& sums : sums_) squares.push_back(sums.left(values_));
    return squares;
}

std::vector<std::size_t> equal_blocks(std::span<const double> weight, std::size_t blocks) {
    const double all = std::accumulate(weight.begin(), weight.end(), 0.0);
    std::vector<std::size_t> numbers;
    double before = 0.0;
    for (const double each : weight) {
        const double share = all > 0.0 ? before / all : 0.0;
        numbers.push_back(
            std::min(static_cast<std::size_t>(share * static_cast<double>(blocks)), blocks - 1));
        before += each;
    }
    return numbers;
}

}  // namespace ripplenotch
