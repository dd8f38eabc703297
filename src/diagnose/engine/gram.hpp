// SPDX-License-Identifier: MIT
#pragma once
// Sums of products of many columns, and least squares from them.

#include <cstddef>
#include <span>
#include <vector>

#include "core/matrices/linear_algebra.hpp"

namespace ripplenotch::engine {

/// Added to the diagonal of normal equations that are scaled to a diagonal of 1: equal columns share.
inline constexpr double ridge = 1e-8;

/// X' X over the rows that count: extends `gram` of the first columns to all of them. Columns may be zero
/// over long stretches, which cost nothing there.
void extend_gram(Eigen::MatrixXd& gram, std::span<const std::span<const double>> columns,
                 std::span<const unsigned char> use);

/// Solves the normal equations of a least-squares fit. `gram` has the target as its first row and column.
/// `extra`: what is added to the diagonal of each unknown once it is scaled to 1, for priors; empty: `ridge`.
[[nodiscard]] Eigen::VectorXd solve_normal_equations(const Eigen::MatrixXd& gram,
                                                     std::span<const double> extra = {});

/// Factors by which the columns are nearest to `target` over the rows that count.
[[nodiscard]] std::vector<double> regress(const std::vector<std::vector<double>>& columns,
                                          const std::vector<double>& target,
                                          std::span<const unsigned char> use);

}  // namespace ripplenotch::engine
