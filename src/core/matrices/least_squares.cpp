// SPDX-License-Identifier: MIT
#include "core/matrices/least_squares.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/matrices/factorisations.hpp"
#include "core/vectors/dot.hpp"

namespace ripplenotch {

namespace {

// Some twenty columns of so many rows stay in a processor's second cache.
constexpr std::size_t block_rows = 256;

// Columns of `rows` numbers, one after another; the right side is the last.
struct Block {
    std::vector<double> numbers;
    std::size_t rows;
    [[nodiscard]] double* column(std::size_t c) { return numbers.data() + c * rows; }
    [[nodiscard]] double& at(std::size_t row, std::size_t c) { return numbers[c * rows + row]; }
};

// Reflects the first `rows` rows of the block into the triangle, column by column: each reflection is of one
// row of the triangle and all of the block.
void reflect(Block& triangle, Block& block, std::size_t rows) {
    const std::size_t count = triangle.rows;
    for (std::size_t c = 0; c < count; ++c) {
        double* const below = block.column(c);
        const double squares = dot(below, below, rows), top = triangle.at(c, c);
        if (!(squares > 0.0)) continue;
        const double length = std::copysign(std::sqrt(top * top + squares), top);
        const double first = top + length, factor = 1.0 / (length * first);
        triangle.at(c, c) = -length;
        for (std::size_t other = c + 1; other <= count; ++other) {
            double* const column = block.column(other);
            double& above = triangle.at(c, other);
            const double along = (first * above + dot(below, column, rows)) * factor;
            above -= along * first;
            add_scaled(-along, below, column, rows);
        }
    }
}

}  // namespace

TallTriangle tall_triangle(std::span<const double> columns, std::span<const double> right) {
    const std::size_t rows = right.size(), count = rows > 0 ? columns.size() / rows : 0;
    Block triangle{std::vector<double>(count * (count + 1), 0.0), count};
    Block block{std::vector<double>(block_rows * (count + 1)), block_rows};
    for (std::size_t row = 0; row < rows; row += block_rows) {
        const std::size_t here = std::min(block_rows, rows - row);
        for (std::size_t c = 0; c < count; ++c) std::copy_n(&columns[c * rows + row], here, block.column(c));
        std::copy_n(&right[row], here, block.column(count));
        reflect(triangle, block, here);
    }
    const auto end_of_triangle = triangle.numbers.begin() + static_cast<std::ptrdiff_t>(count * count);
    return {{triangle.numbers.begin(), end_of_triangle}, {end_of_triangle, triangle.numbers.end()}};
}

std::vector<double> least_squares(const std::vector<std::vector<double>>& columns,
                                  std::span<const double> target) {
    const auto count = static_cast<Eigen::Index>(columns.size());
    Eigen::MatrixXd products(count, count);
    Eigen::VectorXd side(count);
    for (Eigen::Index i = 0; i < count; ++i) {
        const double* const column = columns[static_cast<std::size_t>(i)].data();
        for (Eigen::Index j = 0; j <= i; ++j)
            products(i, j) = products(j, i) =
                dot(column, columns[static_cast<std::size_t>(j)].data(), target.size());
        side(i) = dot(column, target.data(), target.size());
    }
    const Eigen::VectorXd values = RankedFactors(products).solve(side);
    return {values.begin(), values.end()};
}

}  // namespace ripplenotch
