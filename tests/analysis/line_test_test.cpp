// SPDX-License-Identifier: MIT
// The test of a spectral line against its noise, and the running median behind it.
#include <algorithm>
#include <cmath>

#include "analysis/spectrum/running_median.hpp"
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
    const double k = 20.0;
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
    const auto peaks = significant_peaks({power, 1.0, 1.0, 0}, floor, 0.01);
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
    const PowerSpectrum spectrum{power, 1.0, 1.0, 0};
    CHECK(significant_peaks(spectrum, noise_floor(spectrum), 0.01).empty());
}

namespace {

// Noise of so many averages around 1, a value a cell.
std::vector<double> flat_noise(std::size_t bins, int averages, unsigned seed) {
    tests::Noise noise(seed);
    std::vector<double> power(bins, 0.0);
    for (double& p : power) {
        for (int i = 0; i < averages; ++i) {
            const double a = noise(), b = noise();
            p += 0.5 * (a * a + b * b) / averages;
        }
    }
    return power;
}

}  // namespace

TEST_CASE("noise makes a line in one spectrum of a hundred at most, whatever its averages and its low end") {
    std::size_t lines = 0;
    for (const int averages : {1, 3, 10}) {
        for (unsigned seed = 0; seed < 200; ++seed) {
            std::vector<double> power = flat_noise(300, averages, 1000 + seed);
            // As steep as noise behind a resonance.
            for (std::size_t k = 1; k < power.size(); ++k)
                power[k] *= 1.0 + 1e4 * std::pow(3.0 / static_cast<double>(k), 4);
            const PowerSpectrum spectrum{power, static_cast<double>(averages), 1.0, 3, 8};
            lines += significant_peaks(spectrum, noise_floor(spectrum), 0.01).size();
        }
    }
    CHECK(lines <= 12);  // 1 % of 600 logs, and as much again
}

TEST_CASE("the ratio that is exceeded with a chance has that chance") {
    for (const double chance : {0.1, 1e-3, 1e-6})
        CHECK_THAT(exceedance({exceeded(chance, {.averages = 3.0, .cells = 6.0}), 3.0, 6.0}),
                   WithinRel(chance, 1e-6));
}

TEST_CASE("a running median is the median of each window, whatever way the window goes") {
    tests::Noise noise(5);
    std::vector<double> signal(3000);
    for (double& value : signal) value = std::round(20.0 * noise()) / 20.0;  // many equal values
    RunningMedian running(signal);
    std::mt19937 engine(7);
    std::size_t first = 0, count = 121;
    for (int step = 0; step < 2000; ++step) {
        // Forward by a little, with windows that grow and shrink; at times somewhere else entirely.
        first += engine() % 9;
        count = std::clamp<std::size_t>(count + engine() % 5 - engine() % 5, 1, 200);
        if (first + count > signal.size() || engine() % 50 == 0) first = engine() % (signal.size() - count);
        std::vector<double> window(signal.begin() + static_cast<std::ptrdiff_t>(first),
                                   signal.begin() + static_cast<std::ptrdiff_t>(first + count));
        std::sort(window.begin(), window.end());
        REQUIRE(running.at(first, count) == window[count / 2]);
    }
}
