// SPDX-License-Identifier: MIT
#include "fleet/trend/change_test.hpp"

#include <cmath>

#include "ripplenotch/model/noise.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

TEST_CASE("one more column has the t that arithmetic gives") {
    // Three values of 1, 2, 3 and three of 5, 6, 7: means 2 and 6, pooled variance 1, t = 4 / sqrt(2 / 3).
    const std::vector<double> value = {1, 2, 3, 5, 6, 7}, ones(6, 1.0), step = {0, 0, 0, 1, 1, 1};
    const Regression regression(value, {ones});
    const auto extra = regression.extra(step);
    REQUIRE(extra);
    CHECK_THAT(extra->size, WithinRel(4.0, 1e-12));
    CHECK_THAT(extra->error, WithinRel(std::sqrt(2.0 / 3.0), 1e-12));
    CHECK_THAT(extra->t_squared, WithinRel(24.0, 1e-12));
    CHECK_THAT(regression.first_value(), WithinRel(4.0, 1e-12));
}

TEST_CASE("a column that the others hold has nothing to say") {
    const std::vector<double> value = {1, 2, 3, 5, 6, 7}, ones(6, 1.0), step = {0, 0, 0, 1, 1, 1};
    CHECK_FALSE(Regression(value, {ones, step}).extra(step));
    CHECK(Regression(value, {ones, ones, step}).freedom() == 4.0);
}

TEST_CASE("residuals are beside every column") {
    std::vector<double> value, ones, slope;
    Noise noise(3, NoiseChannel::torque);
    for (int i = 0; i < 40; ++i) {
        value.push_back(2.0 + 0.5 * i + noise.normal());
        ones.push_back(1.0);
        slope.push_back(i);
    }
    const Regression regression(value, {ones, slope});
    double along_ones = 0.0, along_slope = 0.0;
    for (std::size_t i = 0; i < value.size(); ++i) {
        along_ones += regression.residual()[i];
        along_slope += regression.residual()[i] * slope[i];
    }
    CHECK_THAT(along_ones, WithinAbs(0.0, 1e-9));
    CHECK_THAT(along_slope, WithinAbs(0.0, 1e-8));
    CHECK_THAT(regression.first_value(), WithinAbs(2.0, 1.0));
}
