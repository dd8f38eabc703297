// SPDX-License-Identifier: MIT
#include "ripplenotch/model/fit.hpp"

#include <cmath>
#include <vector>

#include "support/catch.hpp"

using namespace ripplenotch;

namespace {

std::vector<double> draw(std::uint64_t seed, NoiseChannel channel, std::size_t count) {
    std::vector<double> values(count, 0.0);
    add_noise(values, {.rms = 1.0}, seed, channel);
    return values;
}

double correlation(const std::vector<double>& a, const std::vector<double>& b, std::size_t lag) {
    double sum = 0.0;
    for (std::size_t k = lag; k < a.size(); ++k) sum += a[k] * b[k - lag];
    return sum / static_cast<double>(a.size() - lag);
}

}  // namespace

TEST_CASE("the same seed gives the same noise, another seed another") {
    CHECK(draw(7, NoiseChannel::torque, 1000) == draw(7, NoiseChannel::torque, 1000));
    CHECK(draw(7, NoiseChannel::torque, 1000) != draw(8, NoiseChannel::torque, 1000));
}

TEST_CASE("a longer draw begins with the shorter one") {
    const auto shorter = draw(1, NoiseChannel::torque, 999);
    auto longer = draw(1, NoiseChannel::torque, 2000);
    longer.resize(999);
    CHECK(longer == shorter);
}

TEST_CASE("noise has mean 0, rms 1 and the tails of a normal distribution") {
    constexpr std::size_t n = 1'000'000;
    double mean = 0.0, square = 0.0, fourth = 0.0;
    std::size_t beyond_2 = 0;
    for (const double x : draw(3, NoiseChannel::torque, n)) {
        mean += x;
        square += x * x;
        fourth += x * x * x * x;
        if (std::abs(x) > 2.0) ++beyond_2;
    }
    const double count = static_cast<double>(n);
    // Five standard errors each: 1 / sqrt(n), sqrt(2 / n), sqrt(96 / n), sqrt(p (1 - p) / n) with p = 0.0455.
    CHECK(std::abs(mean / count) < 0.005);
    CHECK(std::abs(square / count - 1.0) < 0.0071);
    CHECK(std::abs(fourth / count - 3.0) < 0.049);
    CHECK(std::abs(static_cast<double>(beyond_2) / count - 0.045500) < 0.00105);
}

TEST_CASE("noise is white, and its channels and neighbouring seeds are unrelated") {
    constexpr std::size_t n = 200'000;
    const auto torque = draw(1, NoiseChannel::torque, n);
    const double limit = 5.0 / std::sqrt(static_cast<double>(n));
    for (std::size_t lag = 1; lag <= 20; ++lag) CHECK(std::abs(correlation(torque, torque, lag)) < limit);
    for (std::size_t lag = 0; lag <= 3; ++lag) {
        CHECK(std::abs(correlation(torque, draw(1, NoiseChannel::velocity, n), lag)) < limit);
        CHECK(std::abs(correlation(torque, draw(2, NoiseChannel::torque, n), lag)) < limit);
    }
}

TEST_CASE("uniform numbers are 0 or above, stay below 1 and fill it") {
    Noise noise(11, NoiseChannel::torque);
    std::vector<int> tenths(10, 0);
    for (int i = 0; i < 100'000; ++i) {
        const double x = noise.uniform();
        REQUIRE(x >= 0.0);
        REQUIRE(x < 1.0);
        ++tenths[static_cast<std::size_t>(10.0 * x)];
    }
    for (const int count : tenths)
        CHECK(std::abs(count - 10'000) < 475);  // five standard errors: 5 sqrt(n p (1 - p))
}

TEST_CASE("noise of rms 0 changes nothing, not even a sign of zero") {
    std::vector<double> values{-0.0, 1.5};
    add_noise(values, {.rms = 0.0}, 1, NoiseChannel::torque);
    CHECK(std::signbit(values[0]));
    CHECK(values[1] == 1.5);
}

// The first numbers of two streams as they were when the files in data/ were made: a change here is a change
// of every simulated log that anyone has kept the seed of.
TEST_CASE("seed 1 means these numbers, on every machine") {
    const auto torque = draw(1, NoiseChannel::torque, 3), velocity = draw(1, NoiseChannel::velocity, 3);
    CHECK(torque == std::vector<double>{0x1.4962babb7f73cp-4, 0x1.f207a2af3a1c7p-1, 0x1.edd92c7933e35p-1});
    CHECK(velocity == std::vector<double>{0x1.dfe86b0945a12p-1, 0x1.e4b915341df6ep-2, 0x1.27c73750ad4c6p-1});
}
