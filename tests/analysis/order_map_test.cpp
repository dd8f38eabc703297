// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/order_map.hpp"

#include "analysis/order_signals.hpp"
#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

namespace {

/// Nearest bin of the axis.
double amplitude_at(const SpeedMap& map, std::size_t row, double where) {
    return map.amplitude_nm[row][static_cast<std::size_t>(std::lround(where / map.spacing))];
}

}  // namespace

TEST_CASE("in an order map of a run-up each order stays in its column with its amplitude") {
    const auto signal = tests::run_up();
    const SpeedMap map = speed_map(signal.view(), signal.turns, signal.speed_deg_s,
                                   {.axis = Axis::angle, .resolution = 0.075, .highest = 7.5});
    CHECK_THAT(map.resolution, WithinRel(0.075, 1e-6));
    REQUIRE(map.speed_deg_s.size() > 5);
    CHECK(std::is_sorted(map.speed_deg_s.begin(), map.speed_deg_s.end()));
    for (std::size_t row = 0; row < map.speed_deg_s.size(); ++row) {
        for (std::size_t i = 0; i < 4; ++i) {
            // Orders fall on bins (spacing 0.025); half a percent is leakage between lines 20 cells apart and
            // samples of unequal weight.
            CHECK_THAT(amplitude_at(map, row, tests::run_up_orders[i]),
                       WithinRel(tests::run_up_amplitudes[i], 0.005));
        }
        CHECK(amplitude_at(map, row, 2.5) < 0.01);
    }
}

TEST_CASE("the highest order that a map shows by default is the alias-free one at the highest speed") {
    const auto signal = tests::run_up();
    const SpeedMap map = speed_map(signal.view(), signal.turns, signal.speed_deg_s, {});
    // 300 Hz over 40 turns a second; the fastest window lies a little below that speed.
    CHECK_THAT(map.axis.back(), WithinAbs(7.5, 0.6));
    CHECK(map.axis.back() >= 7.4);
}

TEST_CASE("a Campbell diagram puts an order on a slope and a tone on a level") {
    auto signal = tests::shaft(tests::straight(20.0, 60.0, 40000), 1000.0);
    tests::add_line(signal, {1.0, 0.8, 0.3});
    for (std::size_t k = 0; k < signal.time_s.size(); ++k) {
        signal.torque_nm[k] += 12.0 + 0.5 * std::cos(2.0 * std::numbers::pi * 150.0 * signal.time_s[k]);
    }
    const SpeedMap map = speed_map(signal.view(), signal.turns, signal.speed_deg_s,
                                   {.axis = Axis::time, .resolution = 3.0, .highest = std::nullopt});
    CHECK_THAT(map.resolution, WithinRel(3.0, 0.01));
    for (std::size_t row = 0; row < map.speed_deg_s.size(); ++row) {
        CHECK_THAT(amplitude_at(map, row, 150.0), WithinRel(0.5, 0.01));
        const auto& values = map.amplitude_nm[row];
        const auto limit = values.begin() + static_cast<std::ptrdiff_t>(100.0 / map.spacing);
        const double peak =
            map.spacing * static_cast<double>(std::max_element(values.begin() + 5, limit) - values.begin());
        // A speed's range is two turns a second wide at most, and so is the ridge.
        CHECK_THAT(peak, WithinAbs(map.speed_deg_s[row] / 360.0, map.speed_step_deg_s / 720.0 + map.spacing));
    }
    CHECK_THAT(map.axis.back(), WithinAbs(500.0, map.spacing));
}

TEST_CASE("a log at one speed is a map of one row, without a division by zero") {
    auto signal = tests::shaft(tests::straight(25.0, 25.0, 5000), 1000.0);
    tests::add_line(signal, {1.0, 0.8, 0.3});
    for (const Axis axis : {Axis::angle, Axis::time}) {
        const SpeedMap map = speed_map(signal.view(), signal.turns, signal.speed_deg_s, {.axis = axis});
        REQUIRE(map.speed_deg_s.size() == 1);
        CHECK_THAT(map.speed_deg_s[0], WithinRel(9000.0, 1e-9));
        for (const double value : map.amplitude_nm[0]) CHECK(std::isfinite(value));
        const auto& row = map.amplitude_nm[0];
        const auto highest = std::max_element(row.begin(), row.end());
        const double line = axis == Axis::angle ? 1.0 : 25.0;
        CHECK_THAT(map.axis[static_cast<std::size_t>(highest - row.begin())], WithinAbs(line, map.spacing));
        // A line between two bins of a Hann window is seen by up to 1.4 dB too low.
        CHECK(*highest < 0.81);
        CHECK(*highest > 0.67);
    }
    const auto rest = tests::shaft(tests::straight(0.0, 0.0, 5000), 1000.0);
    CHECK_THROWS_AS(speed_map(rest.view(), rest.turns, rest.speed_deg_s, {}), DataError);
}

TEST_CASE("a resolution that no run can give is not pretended") {
    const auto signal = tests::run_up();  // 125 turns
    const SpeedMap map = speed_map(signal.view(), signal.turns, signal.speed_deg_s,
                                   {.axis = Axis::angle, .resolution = 0.001, .highest = 7.5});
    CHECK_THAT(map.resolution, WithinRel(1.5 / 125.0, 1e-6));
    CHECK(map.speed_deg_s.size() == 1);
}
