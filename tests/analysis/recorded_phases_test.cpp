// SPDX-License-Identifier: MIT
// Recordings of one joint whose ripple begins at another angle: a wave generator or an encoder that was
// turned.
#include <algorithm>

#include "analysis/traces.hpp"
#include "ripplenotch/analysis/identification.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::Contains;
using Catch::Matchers::WithinAbs;
using tests::identify_all;

namespace {

struct Run {
    double zero_deg = 0.0;   ///< by which the encoder's zero was moved
    double start_deg = 0.0;  ///< where the motion begins
    bool position = true;
    std::uint32_t seed = 1;
};

/// A recording of the same joint, at the speeds given or there and back.
Trace record(const Run& run, double speed_deg_s = 0.0) {
    const auto speed = [speed_deg_s](double t) {
        return speed_deg_s != 0.0 ? speed_deg_s : 80.0 * std::sin(0.8 * t + 0.3);
    };
    constexpr double radians = std::numbers::pi / 180.0;
    Trace trace = tests::make_trace({.rate_hz = 500.0,
                                     .seconds = 8.0,
                                     .speed_deg_s = speed,
                                     .ripple = {{100.0, 0.5, 0.3 + 100.0 * run.start_deg * radians},
                                                {200.0, 0.3, 1.1 + 200.0 * run.start_deg * radians}},
                                     .noise_nm = 0.05,
                                     .position = run.position,
                                     .seed = run.seed});
    for (double& angle : trace.position_deg) angle += run.start_deg + run.zero_deg;
    return trace;
}

std::vector<Disagreement> about_phase(const Identification& found) {
    std::vector<Disagreement> phases;
    std::copy_if(found.disagreements.begin(), found.disagreements.end(), std::back_inserter(phases),
                 [](const Disagreement& one) { return one.about == Disagreement::About::phase; });
    return phases;
}

}  // namespace

TEST_CASE("a recording whose encoder zero was moved is told, with the angle for each order") {
    for (const double zero_deg : {0.4, -0.9, 1.5}) {
        const Identification found = identify_all(
            {record({.seed = 1}), record({.seed = 2}), record({.zero_deg = zero_deg, .seed = 3})});
        INFO(found.verdict);
        const auto phases = about_phase(found);
        REQUIRE_FALSE(phases.empty());
        for (const Disagreement& one : phases) {
            REQUIRE(one.values.size() == 3);
            const auto off = [&](std::size_t i, std::size_t j) {
                const double apart = one.values[i].value - one.values[j].value;
                return apart - 360.0 * std::round(apart / 360.0);
            };
            const double turned = -*one.order * 100.0 * zero_deg;
            CHECK_THAT(off(0, 1), WithinAbs(0.0, 5.0));
            CHECK_THAT(off(2, 0), WithinAbs(turned - 360.0 * std::round(turned / 360.0), 5.0));
        }
        CHECK_THAT(found.verdict, Contains("the recordings disagree: the phase of order "));
        CHECK(found.conclusive);
    }
}

TEST_CASE("recordings that agree are never said to differ in phase: eight seeds, wherever they move") {
    int told = 0;
    for (std::uint32_t run = 0; run < 8; ++run) {
        std::vector<Trace> logs;
        for (std::uint32_t i = 0; i < 3; ++i)
            logs.push_back(record({.start_deg = 70.0 * i, .seed = 100 + 10 * run + i}));
        told += static_cast<int>(about_phase(identify_all(logs)).size());
    }
    CHECK(told == 0);
}

TEST_CASE(
    "steady recordings of like speeds are compared, others are not: a delay turns the phase with the speed") {
    const auto logs = [](double second_speed, double zero_deg) {
        return std::vector{record({.seed = 1}, 60.0), record({.seed = 2}, 90.0),
                           record({.zero_deg = zero_deg, .seed = 3}, second_speed)};
    };
    CHECK(about_phase(identify_all(logs(60.0, 0.0))).empty());
    CHECK(about_phase(identify_all(logs(60.0, 0.5))).size() == 2);
    CHECK(about_phase(identify_all(logs(75.0, 0.5))).empty());
    CHECK(about_phase(identify_all(logs(-60.0, 0.5))).empty());
}

TEST_CASE("without a position in both recordings nothing is said about phases") {
    const bool first = GENERATE(false, true);
    const Identification found = identify_all(
        {record({.position = first, .seed = 1}), record({.zero_deg = 0.9, .position = false, .seed = 2})});
    CHECK(about_phase(found).empty());
}
