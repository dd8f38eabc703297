// SPDX-License-Identifier: MIT
// What a log turns out to be when it is read: rate, gaps, holds, and whether the clock agrees with the
// motion.
#include <cmath>
#include <numbers>
#include <random>

#include "log_support.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::Contains;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;
using test::read_trace;

namespace {

// Ten seconds of a joint that swings by 200 deg at 1 kHz, with noise on velocity and position as sensors have
// it.
Trace swing(double rate = 1000.0, std::size_t rows = 10000) {
    std::mt19937_64 random(7);
    std::normal_distribution<double> noise;
    Trace trace;
    for (std::size_t i = 0; i < rows; ++i) {
        const double t = static_cast<double>(i) / rate, w = 0.9;
        trace.time_s.push_back(t);
        trace.position_deg.push_back(100.0 * std::sin(w * t) + 0.002 * noise(random));
        trace.velocity_deg_s.push_back(100.0 * w * std::cos(w * t) + 0.3 * noise(random));
        trace.torque_nm.push_back(5.0 * std::sin(3.0 * t) + 0.1 * noise(random));
    }
    return trace;
}

}  // namespace

TEST_CASE("the rate is rows over time, not one over the median step", "[log]") {
    // Three steps of 1 ms and one of 2 ms: 4 samples in 5 ms are 800 Hz, while the median says 1000.
    Trace trace = swing();
    double t = 0.0;
    for (std::size_t i = 0; i < trace.size(); ++i) {
        trace.time_s[i] = t;
        t += i % 4 == 3 ? 0.002 : 0.001;
    }
    const Log log = read_trace(trace);
    CHECK_THAT(log.recording.clock.mean_rate.value(), WithinRel(800.0, 1e-4));
    CHECK_THAT(log.recording.clock.usual_step.value(), WithinRel(0.001, 1e-9));
    CHECK_THAT(log.recording.clock.shortest_step.value(), WithinRel(0.001, 1e-9));
    CHECK_THAT(log.recording.clock.longest_step.value(), WithinRel(0.002, 1e-9));
    // Steps 1, 1, 1, 2 ms: mean 1.25, deviations -0.25 three times and 0.75: rms sqrt((3 * 0.0625 + 0.5625) /
    // 4) = 0.433.
    CHECK_THAT(log.recording.clock.jitter.value(), WithinRel(0.000433, 1e-3));
    CHECK(log.recording.clock.gaps.empty());
}

TEST_CASE("a gap is left out of the rate and splits the log", "[log]") {
    Trace trace = swing();
    for (std::size_t i = 5000; i < trace.size(); ++i) trace.time_s[i] += 3.0;
    const Log log = read_trace(trace);
    REQUIRE(log.recording.clock.gaps.size() == 1);
    CHECK(log.recording.clock.gaps[0].row == 4999);
    CHECK_THAT(log.recording.clock.gaps[0].to_s - log.recording.clock.gaps[0].from_s, WithinAbs(3.001, 1e-9));
    CHECK_THAT(log.recording.clock.mean_rate.value(), WithinRel(1000.0, 1e-6));
    CHECK_THAT(log.recording.warnings.at(0).text, Contains("1 gap"));
    REQUIRE(log.clock_factor);
    CHECK_THAT(*log.clock_factor, WithinAbs(1.0, 0.002));
}

TEST_CASE("repeated times are counted", "[log]") {
    Trace trace = swing();
    for (std::size_t i = 0; i < trace.size(); ++i)
        trace.time_s[i] = std::floor(trace.time_s[i] * 100.0) / 100.0;
    const Log log = read_trace(trace);
    CHECK(log.recording.clock.repeated_times == 9000);  // ten rows share a time: nine of ten steps are zero
    CHECK(log.recording.clock.gaps.empty());
    CHECK_THAT(log.recording.clock.mean_rate.value(), WithinRel(1000.0, 2e-3));
    CHECK_THAT(log.recording.warnings.at(0).text, Contains("repeat the time"));
}

TEST_CASE("the clock check gives 1 for a right clock and names what is wrong with others", "[log]") {
    const Trace right = swing();
    REQUIRE(read_trace(right).clock_factor);
    CHECK_THAT(*read_trace(right).clock_factor, WithinAbs(1.0, 0.002));
    CHECK(read_trace(right).recording.warnings.empty());

    struct Mistake {
        double time, velocity, position;
        std::string named;
    };
    const double pi = std::numbers::pi;
    for (const Mistake& mistake :
         {Mistake{1.0 / 1.47, 1, 1, "wrong by this factor"}, Mistake{1, pi / 180, 1, "57.3 = 180/pi"},
          Mistake{1, 180 / pi, 1, "0.01745 = pi/180"}, Mistake{1000, 1, 1, "taken as s"},
          Mistake{1.0 / 60, 1, 1, "60: the time is in minutes"},
          Mistake{1, 1.0 / 6, 1, "6: the velocity is in rpm"},
          Mistake{1, 1.0 / 360, 1, "360: the velocity is in turns"}, Mistake{1, 1, 101, "gear ratio"},
          Mistake{1, -1, 1, "opposite signs"}}) {
        Trace wrong = swing();
        for (double& t : wrong.time_s) t *= mistake.time;
        for (double& v : wrong.velocity_deg_s) v *= mistake.velocity;
        for (double& p : wrong.position_deg) p *= mistake.position;
        const Log log = read_trace(wrong);
        INFO(mistake.named);
        REQUIRE(log.clock_factor);
        CHECK_THAT(*log.clock_factor, WithinRel(mistake.position / mistake.velocity / mistake.time, 0.003));
        REQUIRE(log.recording.warnings.size() == 1);
        CHECK_THAT(log.recording.warnings[0].text, Contains(mistake.named));
    }
}

TEST_CASE("an angle that wraps is made continuous before it is compared", "[log]") {
    for (const double period : {360.0, 2.0 * std::numbers::pi}) {
        Trace trace = swing();
        for (std::size_t i = 0; i < trace.size(); ++i) {
            trace.velocity_deg_s[i] = 0.6 * period;
            trace.position_deg[i] = std::fmod(0.6 * period * trace.time_s[i], period) - 0.5 * period;
        }
        const Log log = read_trace(trace);
        REQUIRE(log.clock_factor);
        CHECK_THAT(*log.clock_factor, WithinAbs(1.0, 1e-6));
    }
}

TEST_CASE("spikes in velocity and position do not change the clock check", "[log]") {
    Trace trace = swing();
    for (std::size_t i = 100; i < trace.size(); i += 1500) trace.velocity_deg_s[i] = 1e5;
    for (std::size_t i = 350; i < trace.size(); i += 2500) trace.position_deg[i] = -7e4;
    const Log log = read_trace(trace);
    REQUIRE(log.clock_factor);
    CHECK_THAT(*log.clock_factor, WithinAbs(1.0, 0.01));
}

TEST_CASE("a joint at rest has no clock factor", "[log]") {
    Trace trace = swing();
    std::mt19937_64 random(3);
    std::normal_distribution<double> noise;
    for (double& v : trace.velocity_deg_s) v = 0.3 * noise(random);
    for (double& p : trace.position_deg) p = 12.0 + 0.01 * noise(random);
    CHECK_FALSE(read_trace(trace).clock_factor);
    trace.position_deg.clear();
    CHECK_FALSE(read_trace(trace).clock_factor);
}

TEST_CASE(
    "held samples are counted while the joint moves, and rest, coarse torque or steady speed are not holds",
    "[log]") {
    Trace held = swing();
    std::size_t planted = 0;
    for (std::size_t i = 1; i < held.size(); i += 20) {
        if (std::abs(held.velocity_deg_s[i - 1]) < 5.0) continue;
        held.torque_nm[i] = held.torque_nm[i - 1];
        held.velocity_deg_s[i] = held.velocity_deg_s[i - 1];
        held.position_deg[i] = held.position_deg[i - 1];
        ++planted;
    }
    CHECK(read_trace(held).recording.held.count == planted);
    CHECK(read_trace(held).recording.held.longest == 1);

    Trace coarse = swing();
    for (double& torque : coarse.torque_nm) torque = std::round(torque / 0.13) * 0.13;
    CHECK(read_trace(coarse).recording.held.count == 0);

    Trace rest = swing();
    for (std::size_t i = 3000; i < rest.size(); ++i) {
        rest.torque_nm[i] = 1.0;
        rest.velocity_deg_s[i] = 0.0;
        rest.position_deg[i] = 4.0;
    }
    CHECK(read_trace(rest).recording.held.count == 0);

    Trace steady = swing();
    steady.position_deg.clear();
    for (double& v : steady.velocity_deg_s) v = 60.0;
    CHECK(read_trace(steady).recording.held.count == 0);
    for (std::size_t i = 1; i < steady.size(); i += 10) steady.torque_nm[i] = steady.torque_nm[i - 1];
    CHECK(read_trace(steady).recording.held.count == 1000);
}

TEST_CASE("a log without clock, velocity or rows is examined without a figure", "[log]") {
    CHECK(read_trace({}).recording.clock.mean_rate.value() == 0.0);
    Trace trace = swing();
    const double nan = std::numeric_limits<double>::quiet_NaN();
    std::fill(trace.time_s.begin(), trace.time_s.end(), nan);
    std::fill(trace.velocity_deg_s.begin(), trace.velocity_deg_s.end(), nan);
    CHECK(read_trace(trace).recording.clock.mean_rate.value() == 0.0);
    CHECK_FALSE(read_trace(trace).clock_factor);
}
