// SPDX-License-Identifier: MIT
#include "analysis/spectrum/stack.hpp"

#include "analysis/spectrum/order_map.hpp"
#include "analysis/traces.hpp"
#include "support/catch.hpp"

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
    const std::span<const double> all(values);
    subtract_line_and_window(values, even_line(look_at_even(all, all, 1.0)), window, left);
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
    CHECK(look_at_even(time, time, 0.5).worst == std::abs(by));
}

TEST_CASE("two parts of a piece tell together what a look at all of it tells") {
    const std::size_t n = GENERATE(2U, 33U, 64U, 95U), cut = GENERATE(1U, 16U, 20U) * n / 33;
    const std::vector<double> values = noise_of(n, 4);
    std::vector<double> time(n);
    for (std::size_t k = 0; k < n; ++k) time[k] = 5.0 + 0.5 * static_cast<double>(k);
    time[n - 1] += 0.125;
    const std::span<const double> t(time), x(values);
    const EvenPart whole = look_at_even(t, x, 0.5);
    const EvenPart both =
        together(look_at_even(t.first(cut), x.first(cut), 0.5), look_at_even(t, x, 0.5, cut));
    CHECK(both.count == n);
    CHECK(both.worst == 0.125);
    CHECK_THAT(both.sum, WithinAbs(whole.sum, 1e-12));
    CHECK_THAT(both.tilt, WithinAbs(whole.tilt, 1e-10));
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
    Piece a, b;
    std::vector<double> power(n / 2 + 1, 0.0), likewise(n / 2 + 1, 0.0);
    CHECK(maker.for_each(even, torque, [&](const Piece& piece) { a = piece; }) == n / 2);
    CHECK(other.for_each(uneven, torque, [&](const Piece& piece) { b = piece; }) == n / 2);
    REQUIRE(a.even);
    REQUIRE_FALSE(b.even);
    CHECK_THAT(a.window_sum, WithinAbs(b.window_sum, 1e-4));
    maker.add_power(1.0, power);
    other.add_power(1.0, likewise);
    for (std::size_t k = 0; k < power.size(); ++k)
        CHECK_THAT(std::sqrt(power[k]), WithinAbs(std::sqrt(likewise[k]), 0.02));
}

TEST_CASE("pieces have the same bits however many samples are handed over at once") {
    const std::size_t n = GENERATE(64U, 65U), part = GENERATE(1U, 70U, 333U);
    std::vector<double> time(2000), torque = noise_of(2000, 12);
    for (std::size_t k = 0; k < time.size(); ++k) time[k] = 0.001 * static_cast<double>(k);
    time[900] += 1e-4;  // one piece or two are uneven
    const auto pieces_of = [&](std::size_t at_once) {
        PieceMaker maker(n, Hertz(1000.0));
        std::vector<double> values;
        std::size_t first = 0;
        for (std::size_t end = 0; end < time.size();) {
            end = std::min(end + at_once, time.size());
            first += maker.for_each(std::span(time).subspan(first, end - first),
                                    std::span(torque).subspan(first, end - first), [&](const Piece& piece) {
                                        values.insert(values.end(), piece.value.begin(), piece.value.end());
                                        values.push_back(piece.middle_s);
                                    });
        }
        return values;
    };
    const std::vector<double> whole = pieces_of(time.size());
    CHECK(whole.size() > 50 * n);
    CHECK(pieces_of(part) == whole);
}

TEST_CASE("a sample off the clock makes every piece that holds it uneven, and no other") {
    const std::size_t n = 64, hop = 32;
    const std::size_t off = GENERATE(0U, 1U, 40U, 100U, 159U);
    std::vector<double> time(160), torque(160, 1.0);
    for (std::size_t k = 0; k < time.size(); ++k) time[k] = 0.001 * static_cast<double>(k);
    time[off] += 1e-4;
    PieceMaker maker(n, Hertz(1000.0));
    std::size_t first = 0;
    maker.for_each(time, torque, [&](const Piece& piece) {
        CHECK(piece.even == (off < first || off >= first + n));
        first += hop;
    });
    CHECK(first == 4 * hop);
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
        maker.for_each(time, torque, [&](const Piece& made) {
            by_moments.add(made);
            by_samples.add(made);
        });
        maker.begin_again();
    }
    CHECK_THAT(by_moments.hz(), WithinAbs(by_samples.hz(), 1e-5 * bin));
    CHECK_THAT(by_moments.amplitude_nm(), WithinAbs(by_samples.amplitude_nm(), 1e-5));
    CHECK_THAT(std::remainder(by_moments.phase_rad() - by_samples.phase_rad(), tau), WithinAbs(0.0, 1e-3));
}
