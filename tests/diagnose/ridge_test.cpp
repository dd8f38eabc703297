// SPDX-License-Identifier: MIT
// Least squares in which each value is drawn towards 0 as by a measurement of its own.
#include "diagnose/case/known_torque.hpp"

#include <cmath>
#include <random>

#include "support/catch.hpp"

using namespace ripplenotch;

TEST_CASE("one column: value and standard error are those of two measurements weighed by their variances") {
    // Four rows of 1 measure 3 with an rms error of 2, so a variance of 1; the prior has one of 4.
    const std::vector<std::vector<double>> columns = {{1.0, 1.0, 1.0, 1.0}};
    const std::vector<double> deviation = {2.0}, target = {3.0, 3.0, 3.0, 3.0};
    const Ridge ridge(columns, deviation, 2.0);
    CHECK(ridge.solve(target)[0] == Approx(3.0 * 1.0 / (1.0 + 1.0 / 4.0)));
    CHECK(ridge.standard_errors()[0] == Approx(1.0 / std::sqrt(1.0 + 1.0 / 4.0)));
}

TEST_CASE("free values are those of plain least squares, and errors cover what noise does to them") {
    std::mt19937_64 random(7);
    std::normal_distribution<double> draw;
    std::vector<std::vector<double>> columns(3, std::vector<double>(400));
    for (auto& column : columns)
        for (double& value : column) value = draw(random);
    const std::vector<double> free(3, any_size), truth = {2.0, -1.0, 0.5};
    const Ridge ridge(columns, free, 0.3);
    const std::vector<double> errors = ridge.standard_errors();
    int covered = 0, all = 0;
    for (int run = 0; run < 200; ++run) {
        std::vector<double> target(400);
        for (std::size_t k = 0; k < target.size(); ++k) {
            target[k] = 0.3 * draw(random);
            for (std::size_t c = 0; c < 3; ++c) target[k] += truth[c] * columns[c][k];
        }
        const std::vector<double> values = ridge.solve(target);
        for (std::size_t c = 0; c < 3; ++c, ++all)
            covered += std::abs(values[c] - truth[c]) < 1.96 * errors[c];
    }
    CHECK(covered > 0.92 * all);
    CHECK(covered < 0.98 * all);
}
