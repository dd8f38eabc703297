// SPDX-License-Identifier: MIT
#include "analysis/piece.hpp"

#include <catch2/catch.hpp>

#include "analysis/line_meter.hpp"
#include "analysis/piece_kernel.hpp"
#include "analysis/traces.hpp"

using namespace ripplenotch;
using Catch::Matchers::WithinAbs;

namespace {

constexpr double tau = 2.0 * std::numbers::pi;

std::vector<double> noise_of(std::size_t n, std::uint32_t seed) {
    tests::Noise noise(seed);
    std::vector<double> values(n);
    for (double& value : values) value = noise();
    return values;
}

}  // namespace

TEST_CASE("the line through a piece leaves neither a mean nor a slope, whatever the length") {
    const std::size_t n = GENERATE(1U, 2U, 15U, 16U, 17U, 64U, 95U);
    std::vector<double> values = noise_of(n, 3), window(n, 1.0), left(n);
    for (std::size_t k = 0; k < n; ++k) values[k] += 7.0 - 0.3 * static_cast<double>(k);
    take_line_and_window(values, even_line(values), window, left);
    double sum = 0.0, tilt = 0.0;
    for (std::size_t k = 0; k < n; ++k) {
        sum += left[k];
        tilt += left[k] * static_cast<double>(k);
    }
    CHECK_THAT(sum, WithinAbs(0.0, 1e-11));
    CHECK_THAT(tilt, WithinAbs(0.0, 1e-9));
}

TEST_CASE("the distance from an even grid is that of the worst sample, early or late") {
    const std::size_t n = GENERATE(1U, 16U, 17U, 70U);
    const std::size_t worst = GENERATE(0U, 1U, 2U) * (n - 1) / 2;
    const double by = GENERATE(-0.25, 0.125);
    std::vector<double> time(n);
    for (std::size_t k = 0; k < n; ++k) time[k] = 5.0 + 0.5 * static_cast<double>(k);
    if (worst == 0) return;  // the first sample is where the grid begins
    time[worst] += by;
    CHECK(off_even_grid(time, 0.5) == std::abs(by));
}

TEST_CASE("power and moments are sums over all samples, the last few included") {
    const std::size_t n = GENERATE(1U, 4U, 7U, 33U);
    const auto value = noise_of(n, 1), place = noise_of(n, 2), cosine = noise_of(n, 3), sine = noise_of(n, 4);
    const Moments moments = turned_moments(value, place, cosine, sine);
    for (std::size_t d = 0; d < moments.size(); ++d) {
        std::complex<double> sum;
        for (std::size_t k = 0; k < n; ++k)
            sum += value[k] * std::pow(place[k], static_cast<double>(d)) *
                   std::complex<double>(cosine[k], sine[k]);
        CHECK(std::abs(moments[d] - sum) <= 1e-12 * (1.0 + std::abs(sum)) * std::pow(4.0, d));
    }
    std::vector<std::complex<double>> sums(n);
    for (std::size_t k = 0; k < n; ++k) sums[k] = {value[k], place[k]};
    std::vector<double> power(n, 1.0);
    add_power(sums, 2.0, power);
    for (std::size_t k = 0; k < n; ++k)
        CHECK_THAT(power[k], WithinAbs(1.0 + 2.0 * std::norm(sums[k]), 1e-12));
}

TEST_CASE("an even piece is detrended, windowed and transformed as an uneven one") {
    const std::size_t n = GENERATE(256U, 255U);
    const double rate = 1000.0;
    std::vector<double> even(n), torque = noise_of(n, 11);
    for (std::size_t k = 0; k < n; ++k) {
        even[k] = 3.0 + static_cast<double>(k) / rate;
        torque[k] += 40.0 + 0.1 * static_cast<double>(k);
    }
    // Off the grid by too much to count as even, by too little to matter.
    std::vector<double> uneven = even;
    uneven[n / 2] += 2e-3 / rate;
    PieceMaker maker(n, Hertz(rate)), other(n, Hertz(rate));
    const Piece& a = maker.make(even, torque);
    const Piece& b = other.make(uneven, torque);
    REQUIRE(a.even);
    REQUIRE_FALSE(b.even);
    CHECK_THAT(a.window_sum, WithinAbs(b.window_sum, 1e-4));
    const auto sums = maker.transform(), likewise = other.transform();
    REQUIRE(sums.size() == likewise.size());
    // Both are sums of 256 values, the one from the first sample on and the other from the middle.
    for (std::size_t k = 0; k < sums.size(); ++k)
        CHECK_THAT(std::abs(sums[k]), WithinAbs(std::abs(likewise[k]), 0.02));
}

TEST_CASE("a sample off the clock makes every piece that holds it uneven, and no other") {
    const std::size_t n = 64, hop = 32;
    const std::size_t off = GENERATE(0U, 1U, 40U, 100U, 159U);
    std::vector<double> time(160), torque(160, 1.0);
    for (std::size_t k = 0; k < time.size(); ++k) time[k] = 0.001 * static_cast<double>(k);
    time[off] += 1e-4;
    PieceMaker maker(n, Hertz(1000.0));
    for (std::size_t first = 0; first + n <= time.size(); first += hop) {
        const Piece& piece = maker.make(std::span(time).subspan(first, n),
                                        std::span(torque).subspan(first, n), first > 0 ? n - hop : 0);
        CHECK(piece.even == (off < first || off >= first + n));
    }
}

TEST_CASE("a line's maximum from moments is the one that Newton's method finds on the samples") {
    const std::size_t n = 512;
    const double rate = 1000.0, bin = rate / static_cast<double>(n);
    const double offset = GENERATE(0.0, 0.1, 0.4, 0.7, -0.45);  // bins from where the search begins
    const double start = 40.3 * bin;
    PieceMaker maker(n, Hertz(rate));
    LineMeter by_moments(start, bin), by_samples(start, bin);
    by_moments.expect_even_pieces(maker.even_time_s());
    for (std::uint32_t piece = 0; piece < 5; ++piece) {
        std::vector<double> time(n), torque = noise_of(n, 20 + piece);
        for (std::size_t k = 0; k < n; ++k) {
            time[k] = piece + static_cast<double>(k) / rate;
            torque[k] = 0.1 * torque[k] + std::cos(tau * (start + offset * bin) * time[k] + piece);
        }
        const Piece& made = maker.make(time, torque);
        by_moments.add(made);
        by_samples.add(made);
    }
    CHECK_THAT(by_moments.hz(), WithinAbs(by_samples.hz(), 1e-5 * bin));
    CHECK_THAT(by_moments.amplitude_nm(), WithinAbs(by_samples.amplitude_nm(), 1e-5));
    CHECK_THAT(std::remainder(by_moments.phase_rad() - by_samples.phase_rad(), tau), WithinAbs(0.0, 1e-3));
}
