// SPDX-License-Identifier: MIT
#pragma once
// Least squares by blocks of rows: what each block says alone, so that any of them can be left out.

#include <span>
#include <vector>

#include "core/matrices/linear_algebra.hpp"

namespace ripplenotch {

class BlockedSquares {
  public:
    /// `block`: of each row. The last block is the greatest number.
    BlockedSquares(const std::vector<std::vector<double>>& columns, std::span<const double> target,
                   std::span<const std::size_t> block);

    [[nodiscard]] std::size_t blocks() const { return sums_.size(); }
    [[nodiscard]] const Eigen::VectorXd& values() const { return values_; }
    /// Values by which the first columns, so many, are nearest to the target without one block.
    [[nodiscard]] const std::vector<Eigen::VectorXd>& values_without() const { return without_; }
    /// Standard error of a value by the delete-a-block jackknife (Efron and Tibshirani 1993, chapter 11).
    [[nodiscard]] double jackknife_error(std::size_t value) const;
    /// Sums of squares that are left of each block by the values found without it.
    [[nodiscard]] std::vector<double> held_out() const;
    /// The same by the values found with it.
    [[nodiscard]] std::vector<double> left() const;

  private:
    struct Sums {
        Eigen::MatrixXd products;
        Eigen::VectorXd side;
        double squares = 0.0;
        [[nodiscard]] double left(const Eigen::VectorXd& values) const;
    };
    std::vector<Sums> sums_;
    Eigen::VectorXd values_;
    std::vector<Eigen::VectorXd> without_;
};

/// Numbers of blocks for rows of which each has so much weight: the same weight in each, in the order of the
/// rows.
[[nodiscard]] std::vector<std::size_t> equal_blocks(std::span<const double> weight, std::size_t blocks);

}  // namespace ripplenotch
