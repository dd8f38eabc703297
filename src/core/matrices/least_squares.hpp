// SPDX-License-Identifier: MIT
#pragma once
// Least squares of a few columns.

#include <algorithm>
#include <array>
#include <cstddef>
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

/// The same of Student's t with these degrees of freedom, 1 or more.
inline double student_95(double freedom) {
    constexpr std::array table{12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228};
    if (freedom <= 10.0) return table[static_cast<std::size_t>(std::max(freedom, 1.0)) - 1];
    return 1.960 + 2.4 / freedom + 3.5 / (freedom * freedom);
}

}  // namespace ripplenotch
