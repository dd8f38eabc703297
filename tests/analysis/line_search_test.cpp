// SPDX-License-Identifier: MIT
// Lines in motion: sums over sweeps, the search, and lines above half the sample rate.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "analysis/traces.hpp"
#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/analysis/line_search.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::Contains;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

namespace {

/// Back and forth with changing speed, as identification trajectories do: two sines without common period.
double wandering(double t) { return 60.0 * std::sin(0.9 * t) + 35.0 * std::sin(2.3 * t + 1.0); }

MotionLines lines_of(const Trace& trace, double false_alarm = 0.01) {
    const TraceView view = trace.view();
    return find_motion_lines({&view, 1}, {.false_alarm = false_alarm});
}

const MotionLine* nearest_order(const MotionLines& found, double order) {
    for (const MotionLine& line : found.lines) {
        if (line.kind == LineKind::order && std::abs(line.order_output - order) < 0.02 * order) return &line;
    }
    return nullptr;
}

}  // namespace

TEST_CASE("orders are found in a motion that is never steady, with amplitude and phase") {
    const bool position = GENERATE(true, false);
    const Trace trace = tests::make_trace({.seconds = 12.0,
                                           .speed_deg_s = wandering,
                                           .ripple = {{100.0, 0.8, 0.4}, {200.0, 0.5, -1.0}},
                                           .noise_nm = 0.2,
                                           .position = position});
    const MotionLines found = lines_of(trace);
    REQUIRE(found.lines.size() == 2);
    for (const auto& [order, amplitude, phase] :
         {std::tuple{100.0, 0.8, 0.4}, std::tuple{200.0, 0.5, -1.0}}) {
        const MotionLine* line = nearest_order(found, order);
        REQUIRE(line != nullptr);
        CHECK_THAT(line->order_output, WithinAbs(order, 4.0 * line->order_stderr + 1e-6));
        CHECK(line->order_stderr < 0.2);
        CHECK_THAT(line->amplitude_nm, WithinRel(amplitude, 0.05));
        REQUIRE(line->phase_deg.has_value() == position);
        if (position) CHECK_THAT(*line->phase_deg, WithinAbs(phase * degrees_per_radian, 8.0));
    }
}

TEST_CASE("an order above half the sample rate is found where the speed distinguishes it from its image") {
    const auto log = [](double swing, std::uint32_t seed) {
        return tests::make_trace({.rate_hz = 250.0,
                                  .seconds = 20.0,
                                  .speed_deg_s = [=](double t) { return 22.0 + swing * std::sin(0.8 * t); },
                                  .ripple = {{2200.0, 0.3, 0.4}},  // at 134 Hz
                                  .noise_nm = 0.1,
                                  .seed = seed});
    };
    for (const std::uint32_t seed : {1U, 2U, 3U}) {
        const MotionLines found = lines_of(log(3.0, seed));
        REQUIRE(found.lines.size() == 1);
        CHECK(found.lines[0].kind == LineKind::order);
        CHECK_THAT(found.lines[0].order_output, WithinAbs(2200.0, 0.5));
        CHECK_THAT(found.lines[0].amplitude_nm, WithinRel(0.3, 0.05));
        // At one speed it cannot be distinguished from its image at 116 Hz: neither is searched.
        const MotionLines steady = lines_of(log(0.0, seed));
        CHECK(steady.lines.empty());
        REQUIRE(steady.searched.has_value());
        CHECK(steady.searched->highest_order < (250.0 - 2200.0 * 22.0 / 360.0) * 360.0 / 22.0);
    }
}

TEST_CASE("a tone at rest does not take from an order that has nearly its frequency in motion") {
    Trace log =
        tests::make_trace({.rate_hz = 500.0,
                           .seconds = 24.0,
                           .speed_deg_s = [](double t) { return std::fmod(t, 8.0) < 4.0 ? 22.0 : 0.0; },
                           .ripple = {{100.0, 0.5, 0.3}},  // at 6.1 Hz
                           .noise_nm = 0.05,
                           .seed = 4});
    for (std::size_t k = 0; k < log.time_s.size(); ++k)
        if (log.velocity_deg_s[k] == 0.0)
            log.torque_nm[k] += 0.6 * std::cos(2.0 * std::numbers::pi * 7.0 * log.time_s[k]);
    const MotionLines found = lines_of(log);
    REQUIRE(found.lines.size() == 2);
    for (const MotionLine& line : found.lines) {
        const bool tone = line.kind == LineKind::tone;
        CHECK_THAT(tone ? line.hz : line.order_output, WithinRel(tone ? 7.0 : 100.0, 0.002));
        CHECK_THAT(line.amplitude_nm, WithinRel(tone ? 0.6 : 0.5, 0.03));
    }
}

TEST_CASE(
    "lines that stand four resolutions apart in short sweeps are all found, though each hides the others") {
    // To and fro over 30 deg: orders 96, 192, 288, 384 are 8, 16, 24 and 32 cycles in a sweep.
    const auto speed = [](double t) { return 15.0 * std::numbers::pi * std::sin(std::numbers::pi * t); };
    for (const std::uint32_t seed : {1U, 2U, 3U}) {
        const Trace trace = tests::make_trace(
            {.rate_hz = 500.0,
             .seconds = 10.0,
             .speed_deg_s = speed,
             .ripple = {{96.0, 0.5, 0.4}, {192.0, 0.4, -1.0}, {288.0, 0.3, 2.0}, {384.0, 0.3, 1.0}},
             .noise_nm = 0.2,
             .seed = seed});
        const MotionLines found = lines_of(trace);
        for (const auto& [order, amplitude] :
             {std::pair{96.0, 0.5}, {192.0, 0.4}, {288.0, 0.3}, {384.0, 0.3}}) {
            CAPTURE(seed, order);
            // Whether it follows the angle, eight cycles in each of ten equal sweeps may not show.
            const auto line = std::find_if(
                found.lines.begin(), found.lines.end(),
                [&](const MotionLine& one) { return std::abs(one.order_output - order) < 0.05 * order; });
            REQUIRE(line != found.lines.end());
            CHECK_THAT(line->amplitude_nm, WithinRel(amplitude, 0.15));
        }
        CHECK(found.lines.size() == 4);
    }
}

TEST_CASE("a tone is not taken for an order, though the speed lingers at its turning points") {
    const Trace trace = tests::make_trace(
        {.seconds = 12.0, .speed_deg_s = wandering, .tones = {{26.0, 1.0, 0.0}}, .noise_nm = 0.05});
    const MotionLines found = lines_of(trace);
    REQUIRE_FALSE(found.lines.empty());
    for (const MotionLine& line : found.lines) CHECK(line.kind == LineKind::tone);
    CHECK_THAT(found.lines.front().hz, WithinAbs(26.0, 0.05));
}

TEST_CASE("an order and a tone that cross are told apart") {
    const Trace trace = tests::make_trace({.seconds = 12.0,
                                           .speed_deg_s = wandering,
                                           .ripple = {{160.0, 0.5, 0.0}},
                                           .tones = {{26.0, 0.5, 0.0}},
                                           .noise_nm = 0.05});
    const MotionLines found = lines_of(trace);
    REQUIRE(nearest_order(found, 160.0) != nullptr);
    CHECK(std::any_of(found.lines.begin(), found.lines.end(), [](const MotionLine& line) {
        return line.kind == LineKind::tone && std::abs(line.hz - 26.0) < 0.05;
    }));
}

TEST_CASE("at one speed, order and tone cannot be told apart, and the line says unknown") {
    const Trace trace = tests::make_trace({.seconds = 6.0,
                                           .speed_deg_s = [](double) { return 60.0; },
                                           .ripple = {{200.0, 0.5, 0.0}},
                                           .noise_nm = 0.1});
    const MotionLines found = lines_of(trace);
    REQUIRE(found.lines.size() == 1);
    CHECK(found.lines[0].kind == LineKind::unknown);
    CHECK_THAT(found.lines[0].order_output, WithinRel(200.0, 0.001));
}

TEST_CASE("noise of any colour, held and coarse samples give orders in at most one log of a hundred") {
    constexpr int runs = 300;
    int alarms = 0;
    for (int run = 0; run < runs; ++run) {
        const double fast = 20.0 + 10.0 * (run % 7), slow = 5.0 + 5.0 * (run % 5);
        const auto speed = [=](double t) {
            return fast * std::sin(1.1 * t + run) + slow * std::sin(2.7 * t);
        };
        Trace trace = tests::make_trace({.rate_hz = 500.0,
                                         .seconds = 8.0,
                                         .speed_deg_s = speed,
                                         .noise_nm = 0.3,
                                         .seed = static_cast<std::uint32_t>(5000 + run)});
        const int kind = run % 5;
        auto& x = trace.torque_nm;
        const double colour = kind == 1 ? 0.9 : kind == 2 ? 0.99 : 0.0;
        for (std::size_t k = 1; k < x.size(); ++k) x[k] += colour * (x[k - 1] - 10.0);
        // A lightly damped resonance at 35 Hz (Q = 10) driven by the noise.
        double a = 0.0, b = 0.0;
        for (std::size_t k = 0; k < x.size() && kind == 3; ++k) {
            const double pole = std::exp(-std::numbers::pi * 3.5 / 500.0);
            const double next = 2.0 * pole * std::cos(2.0 * std::numbers::pi * 35.0 / 500.0) * a -
                                pole * pole * b + x[k] - 10.0;
            b = a;
            a = next;
            x[k] = 10.0 + next;
        }
        for (std::size_t k = 0; k < x.size() && kind == 4; ++k) {
            // Smooth motion torque, coarse steps, every third sample held.
            x[k] = std::round((x[k] + 4.0 * std::cos(1.1 * trace.time_s[k])) / 0.13) * 0.13;
            if (k % 3 == 2) x[k] = x[k - 1];
        }
        const MotionLines found = lines_of(trace);
        alarms += std::any_of(found.lines.begin(), found.lines.end(),
                              [](const MotionLine& l) { return l.kind == LineKind::order; });
    }
    INFO(alarms << " of " << runs);
    CHECK(alarms <= runs / 100);
}

namespace {

Identification identified(const std::vector<Trace>& traces, std::optional<double> hint = std::nullopt) {
    std::vector<TraceView> views;
    for (const Trace& trace : traces) views.push_back(trace.view());
    IdentifyOptions options;
    if (hint) options.hint = GearRatio(*hint);
    return identify(views, options);
}

Trace at_25_hz(double seconds, std::function<double(double)> speed, std::uint32_t seed,
               double order = 202.0) {
    return tests::make_trace({.rate_hz = 25.0,
                              .seconds = seconds,
                              .speed_deg_s = std::move(speed),
                              .ripple = {{order, 0.3, 0.4}},
                              .noise_nm = 0.03,
                              .seed = seed});
}

/// A short move: half a second of rest, up to `top`, almost to the end, as pick-and-place logs have it.
double short_move(double t, double top) {
    if (t < 0.3) return 0.0;
    return t < 0.8 ? top * (t - 0.3) / 0.5 : t < 2.35 ? top : std::max(0.1, top * (1.0 - (t - 2.35) / 0.5));
}

}  // namespace

TEST_CASE(
    "orders above half the sample rate and fixed tones, at several steady speeds, are no orders elsewhere") {
    std::vector<Trace> orders, tones;
    for (const double speed : {47.0, 61.0, 83.0}) {
        const auto seed = static_cast<std::uint32_t>(speed);
        orders.push_back(at_25_hz(
            30.0, [=](double) { return speed; }, seed));
        tones.push_back(tests::make_trace({.rate_hz = 25.0,
                                           .seconds = 30.0,
                                           .speed_deg_s = [=](double) { return speed; },
                                           .tones = {{3.3 + 0.11 * speed - 4.0, 0.3, 0.0}},
                                           .noise_nm = 0.03,
                                           .seed = seed}));
    }
    for (const Line& line : identified(orders).lines)
        CHECK((line.kind != LineKind::order || std::abs(*line.order_output - 202.0) < 0.5));
    for (const Line& line : identified(tones).lines) CHECK(line.kind != LineKind::order);
}

TEST_CASE("a short log of 65 samples shows its order within 2 %") {
    for (const double top : {10.3, 14.7}) {
        const Identification found = identified({at_25_hz(
            2.6, [=](double t) { return short_move(t, top); }, 5)});
        REQUIRE_FALSE(found.lines.empty());
        CHECK_THAT(*found.lines[0].order_output, WithinAbs(202.0, 4.0));
    }
}

TEST_CASE("noise of any colour in logs of 65 samples gives a line in at most one of a hundred") {
    constexpr int runs = 1000;
    for (int kind = 0; kind < 5; ++kind) {
        int orders = 0, any = 0;
        for (int run = 0; run < runs; ++run) {
            const double top = run % 3 == 0 ? 10.3 : run % 3 == 1 ? 14.7 : 60.0;
            Trace log = tests::make_trace({.rate_hz = 25.0,
                                           .seconds = 2.6,
                                           .speed_deg_s = [=](double t) { return short_move(t, top); },
                                           .noise_nm = 0.1,
                                           .seed = static_cast<std::uint32_t>(100 + 7 * run)});
            auto& x = log.torque_nm;
            const double colour = kind == 1 ? 0.7 : kind == 2 ? 0.95 : 0.0;
            for (std::size_t k = 1; k < x.size(); ++k) x[k] += colour * (x[k - 1] - 10.0);
            for (std::size_t k = 0; k < x.size(); ++k) {
                if (kind == 3) x[k] = std::round(x[k] / 0.13) * 0.13;
                if (kind == 4 && k % 3 == 2) x[k] = x[k - 1];
            }
            const Identification found = identified({log});
            any += std::any_of(found.lines.begin(), found.lines.end(),
                               [](const Line& l) { return l.kind != LineKind::tone; });
            orders += std::any_of(found.lines.begin(), found.lines.end(),
                                  [](const Line& l) { return l.kind == LineKind::order; });
        }
        INFO("kind " << kind << ": " << orders << " orders, " << any << " lines of " << runs);
        CHECK(orders <= runs / 100);
        CHECK(any <= runs / 100 + 9);  // 10 expected, three standard deviations more allowed
    }
}
