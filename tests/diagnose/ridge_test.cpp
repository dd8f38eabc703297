// SPDX-License-Identifier: MIT
// What least squares with drawn values leaves of several targets at once.
#include "diagnose/ridge.hpp"

#include <random>

#include "support/catch.hpp"

using namespace ripplenotch;

TEST_CASE("of several targets is left what is left of each by itself, however many there are") {
    std::mt19937_64 random(7);
    std::normal_distribution<double> draw;
    const auto column = [&] {
        std::vector<double> values(2500);  // more than is worked on at once
        for (double& value : values) value = draw(random);
        return values;
    };
    for (const std::size_t columns : {1U, 2U, 5U, 6U}) {
        std::vector<std::vector<double>> basis;
        std::vector<double> deviation;
        for (std::size_t i = 0; i < columns; ++i) {
            basis.push_back(column());
            deviation.push_back(i % 2 == 0 ? any_size : 0.1);
        }
        const Ridge ridge(basis, deviation, 2.0);
        for (const std::size_t targets : {1U, 2U, 3U, 4U}) {
            std::vector<std::vector<double>> all;
            for (std::size_t t = 0; t < targets; ++t) all.push_back(column());
            const auto left = ridge.left(all);
            REQUIRE(left.size() == targets);
            for (std::size_t t = 0; t < targets; ++t) {
                const std::vector<double> alone = ridge.left(all[t]);
                for (std::size_t k = 0; k < alone.size(); ++k)
                    REQUIRE(left[t][k] == Approx(alone[k]).margin(1e-13));  // rounding, of numbers near 1
            }
        }
    }
}
