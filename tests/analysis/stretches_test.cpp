// SPDX-License-Identifier: MIT

#include "ripplenotch/analysis/stretches.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "analysis/traces.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::Matchers::WithinAbs;

namespace {

// Rest for 2 s, a ramp of 1 s, 60 deg/s for 3 s, a ramp of 1 s through zero, -30 deg/s for 2 s.
double staircase(double t) {
    if (t < 2.0) return 0.0;
    if (t < 3.0) return 60.0 * (t - 2.0);
    if (t < 6.0) return 60.0;
    if (t < 7.0) return 60.0 - 90.0 * (t - 6.0);
    return -30.0;
}

}  // namespace

TEST_CASE("steady stretches are found with their speeds, and standstill is called rest") {
    const bool position = GENERATE(true, false);
    Trace trace = tests::make_trace({.seconds = 9.0, .speed_deg_s = staircase, .position = position});
    tests::Noise noise(2);
    for (double& v : trace.velocity_deg_s) v += 0.5 * noise();
    const auto found = steady_stretches(trace.view());
    REQUIRE(found.size() == 3);
    CHECK(found[0].rest);
    CHECK_THAT(found[0].duration.value(), WithinAbs(2.0, 0.1));
    CHECK_FALSE(found[1].rest);
    CHECK_THAT(found[1].speed.value(),
               WithinAbs(60.0, 0.3));  // up to 5 % of the ramp's end belongs to the stretch
    CHECK_THAT(found[1].duration.value(), WithinAbs(3.0, 0.25));
    CHECK_THAT(found[2].speed.value(), WithinAbs(-30.0, 0.2));
    CHECK(found[2].first + found[2].count == trace.size());
}

TEST_CASE("the ramps at the ends of a stretch do not move its speed") {
    const bool position = GENERATE(true, false);
    const double ramp_s = GENERATE(0.1, 0.3, 0.6);
    const auto trapezoid = [=](double t) {
        return 80.0 * std::clamp(std::min(t - 1.5, 6.5 - t) / ramp_s, 0.0, 1.0);
    };
    const Trace trace = tests::make_trace({.seconds = 8.0, .speed_deg_s = trapezoid, .position = position});
    const auto found = steady_stretches(trace.view());
    REQUIRE(found.size() == 3);
    CHECK(found[1].count > static_cast<std::size_t>(1000.0 * (4.9 - 2.0 * ramp_s)));
    // Evenly weighed, their share of the stretch, up to 5 % slow, makes the mean 3e-4 low.
    CHECK_THAT(found[1].speed.value() / 80.0 - 1.0, WithinAbs(0.0, 1e-5));
}

TEST_CASE("a log of one speed is one stretch, and its speed carries an error that covers the truth") {
    Trace trace =
        tests::make_trace({.seconds = 5.0, .speed_deg_s = [](double) { return 90.0; }, .position = false});
    tests::Noise noise(4);
    for (double& v : trace.velocity_deg_s) v += 0.5 * noise();
    const auto found = steady_stretches(trace.view());
    REQUIRE(found.size() == 1);
    CHECK(found[0].count == trace.size());
    CHECK(found[0].speed_error_deg_s < 0.02);  // 0.5 / sqrt(5000) = 0.007
    CHECK_THAT(found[0].speed.value(), WithinAbs(90.0, 4.0 * found[0].speed_error_deg_s));
}

TEST_CASE("a slow ramp yields no stretch longer than its band allows") {
    const Trace trace =
        tests::make_trace({.seconds = 10.0, .speed_deg_s = [](double t) { return 20.0 + 16.0 * t; }});
    for (const Stretch& s : steady_stretches(trace.view(), Seconds(0.2))) {
        const double change = 16.0 * s.duration.value();
        CHECK(change <= 2.0 * 0.05 * s.speed.value() * 1.1 + 2.0);
    }
    CHECK(steady_stretches(trace.view(), Seconds(2.0)).empty());
}

TEST_CASE("a gap in time ends a stretch") {
    Trace trace = tests::make_trace({.seconds = 4.0, .speed_deg_s = [](double) { return 50.0; }});
    for (std::size_t k = 2000; k < 4000; ++k) trace.time_s[k] += 1.0;
    trace.run_starts = {2000};
    const auto found = steady_stretches(trace.view());
    REQUIRE(found.size() == 2);
    CHECK(found[0].count == 2000);
    CHECK(found[1].first == 2000);
}

TEST_CASE("a moving mean keeps a straight line as it is") {
    std::vector<double> line(50);
    for (std::size_t k = 0; k < line.size(); ++k) line[k] = 2.0 + 3.0 * static_cast<double>(k);
    const auto mean = moving_mean(line, 9);
    for (std::size_t k = 0; k < line.size(); ++k) CHECK_THAT(mean[k], WithinAbs(line[k], 1e-9));
}

TEST_CASE("the speed over the angle turned leaves rests out, and tells a swing from a steady turn") {
    const auto of = [](const std::function<double(double)>& speed_deg_s) {
        return whole_log(tests::make_trace({.seconds = 8.0, .speed_deg_s = speed_deg_s}).view());
    };
    const Stretch turn = of([](double t) { return t < 3.0 ? 0.0 : -30.0; });
    CHECK(turn.turning_deg_s == Approx(30.0));
    CHECK(turn.turning_spread_deg_s == Approx(0.0).margin(0.02));  // the jump looks like a little noise
    CHECK_FALSE(turn.smears_orders());
    // Of a sine of size 1: the mean of sin^2 over that of |sin| is pi / 4, and 2 / 3 that of |sin|^3.
    const Stretch swing = of([](double t) { return 40.0 * std::sin(std::numbers::pi * t); });
    CHECK(swing.turning_deg_s == Approx(40.0 * std::numbers::pi / 4.0).epsilon(1e-3));
    CHECK(swing.turning_spread_deg_s ==
          Approx(40.0 * std::sqrt(2.0 / 3.0 - std::numbers::pi * std::numbers::pi / 16.0)).epsilon(1e-3));
    CHECK(swing.smears_orders());
    const Stretch rest = of([](double) { return 0.0; });
    CHECK(rest.turning_deg_s == 0.0);
    CHECK_FALSE(rest.smears_orders());
    CHECK(of([](double t) { return std::sin(20.0 * t); }).turning_deg_s == 0.0);  // four degrees at most
}

TEST_CASE("noise of the velocity is no change of speed") {
    const double speed_deg_s = GENERATE(0.0, 2.0, 60.0), noise_deg_s = GENERATE(0.5, 5.0);
    CAPTURE(speed_deg_s, noise_deg_s);
    Trace trace = tests::make_trace({.seconds = 10.0, .speed_deg_s = [&](double) { return speed_deg_s; }});
    tests::Noise noise(8);
    for (double& v : trace.velocity_deg_s) v += noise_deg_s * noise();
    const Stretch stretch = whole_log(trace.view());
    CHECK_FALSE(stretch.smears_orders());
    if (speed_deg_s < 5.0 * noise_deg_s) {
        CHECK(stretch.turning_deg_s == 0.0);
        return;
    }
    CHECK_THAT(stretch.turning_deg_s, WithinAbs(speed_deg_s, 0.1 * noise_deg_s));
    CHECK(stretch.turning_spread_deg_s < 0.3 * noise_deg_s);
}

TEST_CASE("a slow joint is judged by its own speeds: a ramp to 2 deg/s is not steady, 0.4 deg/s is no rest") {
    const auto ramp = tests::make_trace(
        {.rate_hz = 200.0, .seconds = 20.0, .speed_deg_s = [](double t) { return 0.1 * t; }});
    for (const Stretch& stretch : steady_stretches(ramp.view())) {
        CHECK_FALSE(stretch.rest);
        CHECK(0.1 * stretch.duration.value() < 0.12 * std::abs(stretch.speed.value()));
    }
    const bool position = GENERATE(true, false);
    const auto slow = tests::make_trace(
        {.rate_hz = 200.0, .seconds = 20.0, .speed_deg_s = [](double) { return 0.4; }, .position = position});
    const auto found = steady_stretches(slow.view());
    REQUIRE(found.size() == 1);
    CHECK_FALSE(found[0].rest);
    CHECK_THAT(found[0].speed.value(), WithinAbs(0.4, 1e-6));
}

TEST_CASE("a joint at rest is at rest, however its velocity trembles") {
    Trace still = tests::make_trace({.rate_hz = 500.0, .seconds = 10.0, .position = GENERATE(true, false)});
    tests::Noise noise(5);
    const double trembling = GENERATE(0.0, 0.05, 1.0);
    for (double& v : still.velocity_deg_s) v += trembling * noise();
    const auto found = steady_stretches(still.view());
    REQUIRE_FALSE(found.empty());
    for (const Stretch& stretch : found) CHECK(stretch.rest);
}
