// SPDX-License-Identifier: MIT
#pragma once
// Least squares of a few columns.

#include <span>
#include <vector>

namespace ripplenotch {

// The orthogonal factorisation of columns of many rows, of which only the triangle is wanted.

struct TallTriangle {
    std::vector<double> triangle;  ///< R of Q R, column after column; 0 below the diagonal
    std::vector<double> reached;   ///< the numbers of Q' `right` that the columns can reach, one for each
};

/// By Householder's reflections, a block of rows after another on what the ones before have left (Golub and
/// Van Loan, Matrix Computations, 5.2; in blocks as of Demmel, Grigori, Hoemmen, Langou, 2012): columns of
/// many rows are gone through once and not once for each other one. `columns`: one after another, each with
/// a number for each of `right`. A column of zeros has a row of zeros.
[[nodiscard]] TallTriangle tall_triangle(std::span<const double> columns, std::span<const double> right);

/// Half the width of a two-sided 95 % interval of a normal distribution, in standard errors: the quantile of
/// 0.975.
inline constexpr double normal_95_errors = 1.959963984540054;

/// The values by which the columns, all as long as `target`, are nearest to it. Where columns cannot be told
/// apart, or are 0, the smallest such values. By normal equations: for columns that are no near copies.
[[nodiscard]] std::vector<double> least_squares(const std::vector<std::vector<double>>& columns,
                                                std::span<const double> target);

}  // namespace ripplenotch
