// SPDX-License-Identifier: MIT
// Least squares and factorisations.
#include <cmath>
#include <random>

#include "core/matrices/least_squares.hpp"
#include "core/rows/row_facts.hpp"
#include "core/vectors/lanes.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;

TEST_CASE("least squares: worked arithmetic, and what is left stands upright on every column") {
    const std::vector<std::vector<double>> columns = {{1, 1, 1, 1}, {0, 1, 2, 3}};
    const std::vector<double> target = {1, 3, 2, 6};
    const auto values = least_squares(columns, target);  // slope 7/5, at 0: 3 - 7/5 * 3/2
    REQUIRE(values.size() == 2);
    CHECK(values[0] == Approx(0.9));
    CHECK(values[1] == Approx(1.4));
    for (const auto& column : columns) {
        double along = 0.0;
        for (std::size_t k = 0; k < target.size(); ++k)
            along += column[k] * (target[k] - values[0] - values[1] * columns[1][k]);
        CHECK(std::abs(along) < 1e-12);
    }
}

TEST_CASE("least squares of columns that cannot be told apart shares between them, and nothing gets 0") {
    const std::vector<double> column = {1, 2, 3}, nothing = {0, 0, 0};
    const auto values = least_squares({column, column, nothing}, column);
    CHECK(values[0] == Approx(0.5));
    CHECK(values[1] == Approx(0.5));
    CHECK(std::abs(values[2]) < 1e-12);
}

TEST_CASE("the root mean square of nothing is 0") {
    CHECK(rms(std::vector<double>{3, 4, 0, 0}) == Approx(2.5));
    CHECK(rms(std::vector<double>{}) == 0.0);
}

namespace {

using Column = std::vector<double>;

std::vector<Column> drawn(std::size_t rows, std::size_t count, unsigned seed) {
    std::mt19937 draw(seed);
    std::vector<Column> columns(count, Column(rows));
    for (Column& column : columns) {
        for (double& value : column) value = static_cast<double>(draw()) / 4294967296.0 - 0.3;
    }
    return columns;
}

TallTriangle of(const std::vector<Column>& columns, const Column& right) {
    Column all;
    for (const Column& column : columns) all.insert(all.end(), column.begin(), column.end());
    return tall_triangle(all, right);
}

double product(const double* a, const double* b, std::size_t count) {
    double sum = 0.0;
    for (std::size_t k = 0; k < count; ++k) sum += a[k] * b[k];
    return sum;
}

// By which the columns are nearest to the right side.
Column solved(const TallTriangle& found) {
    const std::size_t count = found.reached.size();
    Column values = found.reached;
    for (std::size_t i = count; i-- > 0;) {
        for (std::size_t c = i + 1; c < count; ++c) values[i] -= found.triangle[c * count + i] * values[c];
        values[i] /= found.triangle[i * count + i];
    }
    return values;
}

}  // namespace

// Rows about one block, several, and no whole number of them.
TEST_CASE("a tall triangle has the products of its columns with each other and with the right side") {
    constexpr std::size_t count = 4;
    for (const std::size_t rows : std::initializer_list<std::size_t>{4, 5, 255, 256, 257, 1000}) {
        const auto columns = drawn(rows, count, static_cast<unsigned>(rows));
        const Column right = drawn(rows, 1, 7)[0];
        const TallTriangle found = of(columns, right);
        REQUIRE(found.triangle.size() == count * count);
        REQUIRE(found.reached.size() == count);
        const double close = 1e-13 * static_cast<double>(rows);
        for (std::size_t a = 0; a < count; ++a) {
            const double* const in_triangle = &found.triangle[a * count];
            for (std::size_t below = a + 1; below < count; ++below) CHECK(in_triangle[below] == 0.0);
            for (std::size_t b = 0; b < count; ++b) {
                CHECK(product(in_triangle, &found.triangle[b * count], count) ==
                      Approx(product(columns[a].data(), columns[b].data(), rows)).margin(close));
            }
            CHECK(product(in_triangle, found.reached.data(), count) ==
                  Approx(product(columns[a].data(), right.data(), rows)).margin(close));
        }
    }
}

// The products of such columns are singular in double precision: 1 + 1e-18 is 1.
TEST_CASE("a tall triangle tells columns apart that differ by a part in a thousand million") {
    auto columns = drawn(900, 2, 3);
    Column right(900);
    for (std::size_t k = 0; k < right.size(); ++k) {
        columns[1][k] = columns[0][k] + 1e-9 * columns[1][k];
        right[k] = 3.0 * columns[0][k] - 2.0 * columns[1][k];
    }
    const Column values = solved(of(columns, right));
    CHECK(values[0] == Approx(3.0).epsilon(1e-5));
    CHECK(values[1] == Approx(-2.0).epsilon(1e-5));
}

TEST_CASE("a column of zeros has a row of zeros, and the others are as without it") {
    auto columns = drawn(600, 3, 5);
    columns[1].assign(600, 0.0);
    const Column right = drawn(600, 1, 6)[0];
    const TallTriangle found = of(columns, right), without = of({columns[0], columns[2]}, right);
    for (std::size_t c = 0; c < 3; ++c) CHECK(found.triangle[c * 3 + 1] == 0.0);
    CHECK(found.triangle[6] == without.triangle[2]);
    CHECK(found.triangle[8] == without.triangle[3]);
    CHECK(found.reached[2] == without.reached[1]);
}

TEST_CASE("a tall triangle has the same bits with and without wide vectors") {
    const auto columns = drawn(1000, 5, 11);
    const Column right = drawn(1000, 1, 12)[0];
    const TallTriangle wide = of(columns, right);
    const NarrowVectors narrow;
    const TallTriangle plain = of(columns, right);
    CHECK(wide.triangle == plain.triangle);
    CHECK(wide.reached == plain.reached);
}
