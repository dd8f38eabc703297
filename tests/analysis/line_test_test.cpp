// SPDX-License-Identifier: MIT
#include <cmath>

#include "analysis/traces.hpp"
#include "ripplenotch/analysis/line_test.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

TEST_CASE("the median of one exponential lies at ln 2 of its mean, that of many nearly at the mean") {
    CHECK_THAT(median_over_mean(1.0), WithinRel(std::log(2.0), 2e-3));
    CHECK_THAT(median_over_mean(100.0), WithinRel(1.0 - 1.0 / 300.0, 1e-4));
}

TEST_CASE("with a floor known exactly, one average exceeds r times it with chance exp(-r)") {
    for (const double ratio : {1.0, 5.0, 12.0})
        CHECK_THAT(exceedance({.ratio = ratio, .averages = 1.0, .cells = 1e7}),
                   WithinRel(std::exp(-ratio), 1e-3));
    // Two averages: (1 + 2 r) exp(-2 r).
    CHECK_THAT(exceedance({.ratio = 4.0, .averages = 2.0, .cells = 1e7}),
               WithinRel(9.0 * std::exp(-8.0), 1e-3));
}

TEST_CASE("a floor known from few cells makes high ratios likelier, by (1 + r/k)^-k") {
    const double k = 0.48 * 20.0;
    CHECK_THAT(exceedance({.ratio = 10.0, .averages = 1.0, .cells = 20.0}),
               WithinRel(std::pow(1.0 + 10.0 / k, -k), 1e-9));
}

TEST_CASE("the noise floor is the mean power of the noise and is not raised by a line") {
    tests::Noise noise(11);
    std::vector<double> power(4000);
    double mean = 0.0;
    for (double& p : power) {
        const double a = noise(), b = noise();
        p = 0.5 * (a * a + b * b) * 3.0;
        mean += p / 4000.0;
    }
    power[2000] = 1e6;
    const auto floor = noise_floor({power, 1.0, 1.0, 0});
    double average = 0.0;
    for (const double f : floor) average += f / 4000.0;
    CHECK_THAT(average, WithinRel(mean, 0.05));
    CHECK(floor[2000] < 2.0 * mean);
    const auto peaks = significant_peaks({power, 1.0, 1.0, 0}, 0.01);
    REQUIRE(peaks.size() == 1);
    CHECK(peaks[0].bin == 2000);
}

TEST_CASE("a broad hump is no line") {
    tests::Noise noise(13);
    std::vector<double> power(2000);
    for (std::size_t k = 0; k < power.size(); ++k) {
        const double a = noise(), b = noise();
        const double u = (static_cast<double>(k) - 1000.0) / 30.0;
        power[k] = 0.5 * (a * a + b * b) * (1.0 + 100.0 * std::exp(-u * u));
    }
    CHECK(significant_peaks({power, 1.0, 1.0, 0}, 0.01).empty());
}
