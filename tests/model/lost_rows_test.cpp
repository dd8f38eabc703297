// SPDX-License-Identifier: MIT
#include "model/motion/lost_rows.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include "ripplenotch/model/motions.hpp"
#include "ripplenotch/model/prediction.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;

namespace {

struct Stamped {
    std::vector<std::size_t> kept;
    std::vector<double> time_s;
};

// A kilohertz of which three rows in a hundred are lost, with stamps that are off by up to 0.35 of a step.
Stamped stamped(std::size_t count, std::uint32_t seed) {
    std::mt19937 bits(seed);
    Stamped log;
    const auto part = [&] { return static_cast<double>(bits()) / 4294967296.0; };
    for (std::size_t k = 0; k < count; ++k) {
        const double late = 0.35 * (part() - 0.5) + 0.35 * (part() - 0.5);
        if (k > 0 && part() < 0.03) continue;
        log.kept.push_back(k);
        log.time_s.push_back(1e-3 * (static_cast<double>(k) + late));
    }
    return log;
}

}  // namespace

TEST_CASE("rows that are missing are found though stamps jitter") {
    for (std::uint32_t seed = 1; seed <= 20; ++seed) {
        CAPTURE(seed);
        const Stamped log = stamped(20000, seed);
        double step_s = 0.0;
        const auto places = places_of_rows(log.time_s, step_s);
        REQUIRE(places.size() == log.kept.size());
        CHECK(places == log.kept);
        CHECK(step_s == Approx(1e-3).epsilon(1e-3));
    }
}

TEST_CASE("a log of which nothing is missing has no other clock") {
    double step_s = 0.0;
    std::vector<double> even, cut;
    for (std::size_t k = 0; k < 5000; ++k) even.push_back(1e-3 * static_cast<double>(k));
    CHECK(places_of_rows(even, step_s).empty());
    // Stretches with seconds between them are no lost rows.
    for (std::size_t k = 0; k < 5000; ++k) cut.push_back(even[k] + 3.0 * static_cast<double>(k / 500));
    CHECK(places_of_rows(cut, step_s).empty());
}

TEST_CASE("what is filled in is the signal to the error of a cubic") {
    const std::vector<std::size_t> places = {0, 1, 2, 4, 5, 6, 8, 9, 10};
    std::vector<double> cubic;
    const auto value = [](std::size_t k) {
        const auto x = static_cast<double>(k);
        return 1.0 - 2.0 * x + 0.3 * x * x - 0.02 * x * x * x;
    };
    for (const std::size_t place : places) cubic.push_back(value(place));
    const auto whole = with_lost_rows(cubic, places);
    REQUIRE(whole.size() == 11);
    for (std::size_t k = 0; k < whole.size(); ++k) CHECK(whole[k] == Approx(value(k)));
}

TEST_CASE("a delay along a log that lost rows is that of the whole log") {
    const Motion whole = make_motion("constant,speed=120deg/s,duration=4s", Hertz(1000.0));
    const Stamped log = stamped(whole.size(), 2);
    Motion part = whole;
    part.time_s = log.time_s;
    part.position_deg.clear();
    part.velocity_deg_s.assign(log.kept.size(), 120.0);
    part.acceleration_deg_s2.assign(log.kept.size(), 0.0);
    for (const std::size_t k : log.kept) part.position_deg.push_back(whole.position_deg[k]);
    part.sample_rate = Hertz(970.0);
    for (const char* late : {"delay,delay_s=0.0083", "lag,time_constant_s=0.006"}) {
        CAPTURE(late);
        Model model{GearRatio(100.0), {}};
        model.terms.push_back(parse_term("ripple,order=1,amplitude_nm=1,phase_deg=20"));
        model.terms.push_back(parse_term(late));
        const auto expected = predict_nm(model, whole), found = predict_nm(model, part);
        for (std::size_t k = 200; k + 200 < found.size(); ++k)
            REQUIRE(std::abs(found[k] - expected[log.kept[k]]) < 5e-3);
    }
}
