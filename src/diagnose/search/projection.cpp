// SPDX-License-Identifier: MIT
#include "diagnose/search/projection.hpp"

#include <cmath>
#include <utility>

#include "core/vectors/dot.hpp"

namespace ripplenotch {
namespace {

void take_off(std::span<const Column> basis, Column& column) {
    for (const Column& other : basis)
        add_scaled(-product(other, column), other.data(), column.data(), column.size());
}

double length_of_column(const Column& column) { return std::sqrt(product(column, column)); }

// A row for each column of `a`, with its products with each of `b`; two by two.
std::vector<Column> products(std::span<const Column> a, std::span<const Column* const> b) {
    std::vector<Column> all(a.size(), Column(b.size()));
    for (std::size_t i = 0; i < a.size(); i += 2) {
        const std::size_t next_i = i + 1 < a.size() ? i + 1 : i;
        for (std::size_t j = 0; j < b.size(); j += 2) {
            const std::size_t next_j = j + 1 < b.size() ? j + 1 : j;
            double sums[4] = {};
            add_dots({a[i].data(), a[next_i].data()}, {b[j]->data(), b[next_j]->data()}, a[i].size(), sums);
            all[i][j] = sums[0];
            all[i][next_j] = sums[next_j - j];
            all[next_i][j] = sums[2 * (next_i - i)];
            all[next_i][next_j] = sums[2 * (next_i - i) + (next_j - j)];
        }
    }
    return all;
}

}  // namespace

double product(const Column& a, const Column& b) { return dot(a.data(), b.data(), a.size()); }

// A column that keeps most of its length is orthogonal to rounding after one pass; twice is enough for any
// other (Kahan, Parlett).
std::vector<Column> orthonormal(std::span<const Column> columns) {
    std::vector<Column> basis;
    for (const Column& given : columns) {
        const double length = length_of_column(given);
        if (!(length > 0.0)) continue;
        Column column = given;
        take_off(basis, column);
        if (length_of_column(column) < 0.5 * length) take_off(basis, column);
        const double left = length_of_column(column);
        if (!(left > 1e-7 * length)) continue;
        for (double& value : column) value /= left;
        basis.push_back(std::move(column));
    }
    return basis;
}

Column outside_of(std::span<const Column> basis, Column column) {
    take_off(basis, column);
    return column;
}

double explained(std::span<const Column> basis, std::span<const Column> columns, const Column& left) {
    constexpr double least_square = 1e-10;
    const std::size_t count = columns.size();
    std::vector<const Column*> with_left;
    for (const Column& column : columns) with_left.push_back(&column);
    with_left.push_back(&left);
    const std::vector<Column> along = products(basis, with_left), among = products(columns, with_left);
    // Rows of a triangle whose square is the products of what lies outside the basis (Cholesky); its last
    // column is what each new direction explains.
    std::vector<Column> triangle(count, Column(count + 1, 0.0));
    double sum = 0.0;
    for (const Column& row : along) sum += row[count] * row[count];
    for (std::size_t c = 0; c < count; ++c) {
        const auto outside = [&](std::size_t d) {
            double value = among[c][d];
            for (const Column& row : along) value -= row[c] * row[d];
            for (std::size_t before = 0; before < c; ++before)
                value -= triangle[before][c] * triangle[before][d];
            return value;
        };
        const double square = outside(c);
        if (!(square > least_square * among[c][c])) continue;
        triangle[c][c] = std::sqrt(square);
        for (std::size_t d = c + 1; d <= count; ++d) triangle[c][d] = outside(d) / triangle[c][c];
        sum += triangle[c][count] * triangle[c][count];
    }
    return sum;
}

}  // namespace ripplenotch
