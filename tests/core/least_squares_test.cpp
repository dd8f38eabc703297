// SPDX-License-Identifier: MIT
#include "core/matrices/least_squares.hpp"

#include "core/rows/row_facts.hpp"
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
