// SPDX-License-Identifier: MIT
// Motion as a log has it: between the steps of an encoder, with a velocity that is off, steady and at rest.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "analysis/lines/encoder.hpp"
#include "analysis/traces.hpp"
#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/analysis/stretches.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::Contains;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

namespace {

/// 500 Hz over 20 s, back and forth at 20 and 40 deg/s, orders 100 and 200.
Trace moving(std::uint32_t seed) {
    const auto speed = [](double t) {
        const double within = std::fmod(t, 5.0), ramp = std::min({1.0, within / 0.2, (5.0 - within) / 0.2});
        return ramp * (t < 10.0 ? 20.0 : 40.0) * (std::fmod(t, 10.0) < 5.0 ? 1.0 : -1.0);
    };
    return tests::make_trace({.rate_hz = 500.0,
                              .seconds = 20.0,
                              .speed_deg_s = speed,
                              .ripple = {{100.0, 0.8, 0.3}, {200.0, 0.5, 1.1}},
                              .noise_nm = 0.05,
                              .seed = seed});
}

using Changed = std::function<double(std::size_t row, double position, double rounded)>;

/// The position rounded to so many bits a turn; `change_nm` is added to the torque.
Trace stepped(const Trace& exact, int bits, const Changed& change_nm = {}) {
    Trace log = exact;
    const double step = 360.0 / std::ldexp(1.0, bits);
    for (std::size_t k = 0; k < log.size(); ++k) {
        const double position = log.position_deg[k], rounded = std::round(position / step) * step;
        log.position_deg[k] = rounded;
        if (change_nm) log.torque_nm[k] += change_nm(k, position, rounded);
    }
    return log;
}

void check_both_orders_alone(const Identification& found) {
    INFO(found.verdict);
    REQUIRE(found.lines.size() == 2);
    for (const Line& line : found.lines) {
        REQUIRE(line.order_output.has_value());
        const bool first = *line.order_output < 150.0;
        CHECK_THAT(*line.order_output, WithinRel(first ? 100.0 : 200.0, 1e-3));
        CHECK_THAT(line.amplitude_nm, WithinRel(first ? 0.8 : 0.5, 0.02));
    }
}

}  // namespace

TEST_CASE("between the steps of an encoder the angle is known to a fifth of a step") {
    const Trace exact = moving(1);
    for (const int bits : {12, 13, 14, 15}) {
        const double step = std::ldexp(1.0, -bits);
        std::vector<double> turns;
        for (const double position : stepped(exact, bits).position_deg) turns.push_back(position / 360.0);
        const OutputAngle angle = between_steps(exact.view(), turns);
        CHECK_THAT(angle.step_turns, WithinRel(step, 1e-6));
        double squares = 0.0;
        for (std::size_t k = 0; k < exact.size(); ++k)
            squares += std::pow(angle.turns[k] - exact.position_deg[k] / 360.0, 2);
        CHECK(std::sqrt(squares / static_cast<double>(exact.size())) < 0.2 * step / std::sqrt(12.0) * 2.0);
    }
    std::vector<double> fine;
    for (const double position : exact.position_deg) fine.push_back(position / 360.0);
    CHECK(between_steps(exact.view(), fine).step_turns == 0.0);
    CHECK(between_steps(exact.view(), fine).turns == fine);
}

TEST_CASE("a position of 12 to 15 bits makes no lines, and takes nothing off those that are there") {
    for (const int bits : {12, 13, 14, 15}) {
        const Identification found = tests::identify_all({stepped(moving(2), bits)});
        check_both_orders_alone(found);
        CHECK(found.notes.empty());
    }
}

TEST_CASE("what a drive makes of its rounded position is foretold, and noted") {
    for (const int bits : {12, 14}) {
        const double step = 360.0 / std::ldexp(1.0, bits);
        const Trace log = stepped(moving(3), bits, [step](std::size_t, double position, double rounded) {
            return 0.15 * (rounded - position) / step;
        });
        const Identification found = tests::identify_all({log});
        check_both_orders_alone(found);
        REQUIRE(found.notes.size() == 1);
        CHECK_THAT(found.notes.front(), Contains("made by the steps of the position's encoder"));
    }
}

TEST_CASE("a joint that moves with its ripple by less than a step keeps its lines") {
    Trace log = moving(4);
    for (double& position : log.position_deg)
        position += 0.005 * std::cos(100.0 * position / degrees_per_radian);
    check_both_orders_alone(tests::identify_all({stepped(log, 12)}));
}

// What a velocity is off by, told by the ripple of a log that has no position.

namespace {

/// A joint that goes to and fro for 12 s, its velocity logged with noise and an offset, no position.
struct Drawn {
    double ratio = 0.0, offset_deg_s = 0.0;
    Trace trace;
};

Drawn to_and_fro(std::uint32_t number, bool position) {
    std::mt19937 drawn(70000 + number);
    const auto between = [&](double low, double high) {
        return low + (high - low) * static_cast<double>(drawn()) / 4294967296.0;
    };
    Drawn one{between(80.0, 160.0), between(-0.5, 0.5), {}};
    const double fast = between(30.0, 70.0), slow = between(5.0, 20.0);
    tests::TraceRecipe recipe;
    recipe.rate_hz = 250.0;
    recipe.seconds = 12.0;
    recipe.noise_nm = 0.2;
    recipe.position = position;
    recipe.seed = number;
    recipe.ripple = {{one.ratio, 0.5, between(0.0, 6.28)}, {2.0 * one.ratio, 0.4, between(0.0, 6.28)}};
    recipe.speed_deg_s = [=](double t) { return fast * std::sin(1.1 * t) + slow * std::sin(2.7 * t + 1.0); };
    one.trace = tests::make_trace(recipe);
    tests::Noise noise(900 + number);
    for (std::size_t k = 0; k < one.trace.size(); ++k)
        one.trace.velocity_deg_s[k] =
            recipe.speed_deg_s(one.trace.time_s[k]) + one.offset_deg_s + 0.2 * noise();
    return one;
}

/// With the nominal ratio as a hint: lines at one and two times it alone leave its half.
Identification identified(const Drawn& one) {
    IdentifyOptions options;
    options.hint = GearRatio(std::round(one.ratio));
    return tests::identify_all({one.trace}, options);
}

}  // namespace

TEST_CASE("the ripple tells what a velocity is off by, and the ratio does not mind") {
    constexpr std::uint32_t logs = 40;
    std::size_t ratios = 0, offsets = 0;
    for (std::uint32_t number = 0; number < logs; ++number) {
        const Drawn one = to_and_fro(number, false);
        const Identification found = identified(one);
        INFO("log " << number);
        REQUIRE(found.gear_ratio.value);
        REQUIRE(found.velocity_error);
        const VelocityError& told = *found.velocity_error;
        ratios += found.gear_ratio.ci95_low <= one.ratio && one.ratio <= found.gear_ratio.ci95_high;
        offsets += std::abs(told.offset.value() - one.offset_deg_s) < 1.96 * told.offset_error.value();
        // Sharp enough to be of use, and never far beyond what they say of themselves.
        CHECK(told.offset_error.value() < 0.15);
        CHECK(std::abs(told.offset.value() - one.offset_deg_s) < 5.0 * told.offset_error.value());
    }
    // Of 40 intervals that hold in 95 of a hundred, 33 and more hold in all but one of 1000 draws.
    INFO(ratios << " ratios, " << offsets << " offsets");
    CHECK(ratios >= 33);
    CHECK(offsets >= 33);
}

TEST_CASE("where a position tells the angle nothing is said of the velocity") {
    const Identification found = identified(to_and_fro(1, true));
    REQUIRE(found.gear_ratio.value);
    CHECK_FALSE(found.velocity_error);
}

TEST_CASE("a velocity in coarse steps makes the ratio's interval as wide as its sum is off") {
    std::size_t ratios = 0;
    for (std::uint32_t number = 0; number < 40; ++number) {
        Drawn one = to_and_fro(number, false);
        for (double& velocity : one.trace.velocity_deg_s) velocity = 2.0 * std::round(0.5 * velocity);
        const Identification found = identified(one);
        INFO("log " << number);
        REQUIRE(found.gear_ratio.value);
        ratios += found.gear_ratio.ci95_low <= one.ratio && one.ratio <= found.gear_ratio.ci95_high;
        CHECK(std::abs(*found.gear_ratio.value / one.ratio - 1.0) < 0.005);
        // In so coarse an angle a second comb one turn away cannot be excluded, and the interval says so.
        CHECK(found.gear_ratio.standard_error < 0.004 * one.ratio + 0.5);
    }
    CHECK(ratios >= 33);
}

TEST_CASE(
    "the noise of a velocity is found beside motion, whatever its rate, and steps of an encoder count as "
    "noise") {
    for (const double rate : {200.0, 1000.0, 4000.0}) {
        for (const double deviation : {0.05, 0.5}) {
            CAPTURE(rate, deviation);
            std::mt19937_64 engine(3);
            std::normal_distribution<double> normal(0.0, deviation);
            Trace trace;
            trace.sample_rate = Hertz(rate);
            for (int k = 0; k < static_cast<int>(10.0 * rate); ++k) {
                trace.time_s.push_back(k / rate);
                trace.velocity_deg_s.push_back(60.0 * std::sin(2.0 * 3.141592653589793 * 0.5 * k / rate) +
                                               normal(engine));
                trace.torque_nm.push_back(0.0);
            }
            CHECK_THAT(velocity_noise(trace.view()).value(), Catch::Matchers::WithinRel(deviation, 0.06));
            for (double& v : trace.velocity_deg_s)
                v = std::round(v / 2.0) * 2.0;  // steps of 2 deg/s: 2 / sqrt(12)
            CHECK_THAT(velocity_noise(trace.view()).value(),
                       Catch::Matchers::WithinAbs(std::hypot(deviation, 0.577), 0.25));
        }
    }
    Trace still;
    still.sample_rate = Hertz(1000.0);
    CHECK(velocity_noise(still.view()).value() == 0.0);
}

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
