// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/alias.hpp"

#include "analysis/traces.hpp"
#include "ripplenotch/analysis/identification.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::Contains;
using Catch::Matchers::WithinAbs;

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

TEST_CASE("an order above half the sample rate is found at its own place from three steady speeds") {
    std::vector<Trace> logs;
    std::uint32_t seed = 1;
    for (const double speed : {47.0, 61.0, 83.0})
        logs.push_back(at_25_hz(
            30.0, [=](double) { return speed; }, seed++));
    const Identification found = identified(logs);
    REQUIRE(found.lines.size() == 1);
    CHECK(found.lines[0].kind == LineKind::order);
    CHECK_THAT(*found.lines[0].order_output, WithinAbs(202.0, 0.2));
    CHECK_THAT(found.lines[0].amplitude_nm, WithinAbs(0.3, 0.01));
    REQUIRE(found.lines[0].by_speed.size() >= 3);
    for (const AmplitudeAtSpeed& at : found.lines[0].by_speed)
        CHECK_THAT(at.hz, WithinAbs(202.0 * at.speed_deg_s / 360.0, 0.02));
}

TEST_CASE("two speeds show an order at its own place or leave it open, and three fixed tones are no order") {
    const Identification two = identified({at_25_hz(
                                               30.0, [](double) { return 47.0; }, 1),
                                           at_25_hz(
                                               30.0, [](double) { return 61.0; }, 2)});
    REQUIRE_FALSE(two.lines.empty());
    for (const Line& line : two.lines)
        CHECK((line.kind == LineKind::unknown || std::abs(*line.order_output - 202.0) < 0.2));
    std::vector<Trace> logs;
    for (const double speed : {47.0, 61.0, 83.0}) {
        logs.push_back(tests::make_trace({.rate_hz = 25.0,
                                          .seconds = 30.0,
                                          .speed_deg_s = [=](double) { return speed; },
                                          .tones = {{3.3 + 0.11 * speed - 4.0, 0.3, 0.0}},
                                          .noise_nm = 0.03,
                                          .seed = static_cast<std::uint32_t>(speed)}));
    }
    for (const Line& line : identified(logs).lines) CHECK(line.kind != LineKind::order);
}

TEST_CASE("in motion of varying speed an order beyond half the sample rate is found at its own place") {
    const Identification found = identified({at_25_hz(
        60.0, [](double t) { return 55.0 + 20.0 * std::sin(0.7 * t); }, 3)});
    REQUIRE(found.lines.size() == 1);
    CHECK_THAT(*found.lines[0].order_output, WithinAbs(202.0, 0.5));
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
