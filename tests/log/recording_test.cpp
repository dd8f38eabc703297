// SPDX-License-Identifier: MIT
// What is found out about a recording.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "log/account/account.hpp"
#include "log_support.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::Contains;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;
using test::read_trace;

// What a log turns out to be when it is read: rate, gaps, holds, and whether the clock agrees with the
// motion.

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

// Is a position this joint's? By scale, sign, wrap and standing still; and where the log contradicts itself.

using Verdict = AngleFacts::Verdict;

namespace {

struct Row {
    double time_s, velocity_deg_s, position_deg;
};

Trace swing(const std::function<void(std::size_t, Row&)>& change, std::size_t rows = 30000) {
    std::mt19937_64 random(7);
    std::normal_distribution<double> noise;
    Trace trace;
    for (std::size_t k = 0; k < rows; ++k) {
        const double t = static_cast<double>(k) / 1000.0, w = 0.9;
        Row row{t, 100.0 * w * std::cos(w * t) + 0.3 * noise(random),
                100.0 * std::sin(w * t) + 0.002 * noise(random)};
        change(k, row);
        trace.time_s.push_back(row.time_s);
        trace.velocity_deg_s.push_back(row.velocity_deg_s);
        trace.torque_nm.push_back(noise(random));
        trace.position_deg.push_back(row.position_deg);
    }
    return trace;
}

Recording recording_of(const std::function<void(std::size_t, Row&)>& change) {
    return read_trace(swing(change)).recording;
}

}  // namespace

TEST_CASE("a position is judged by scale, sign and motion, and what was decided is told", "[log]") {
    struct Case {
        Verdict verdict;
        std::string told;
        std::function<void(std::size_t, Row&)> change;
    };
    const std::vector<Case> cases = {
        {Verdict::agrees, "", [](std::size_t, Row&) {}},
        {Verdict::agrees, "", [](std::size_t, Row& row) { row.position_deg += 1e4; }},
        {Verdict::agrees, "clock is wrong", [](std::size_t, Row& row) { row.position_deg *= 1.475; }},
        {Verdict::scaled, "times as much", [](std::size_t, Row& row) { row.position_deg *= 0.3; }},
        {Verdict::scaled, "gear ratio", [](std::size_t, Row& row) { row.position_deg *= 100.0; }},
        {Verdict::scaled, "gear ratio", [](std::size_t, Row& row) { row.position_deg *= -100.0 * -1.0; }},
        {Verdict::scaled, "57.3", [](std::size_t, Row& row) { row.velocity_deg_s *= 0.0174533; }},
        {Verdict::reversed, "opposite signs", [](std::size_t, Row& row) { row.position_deg *= -1.0; }},
        {Verdict::stands, "position is constant", [](std::size_t, Row& row) { row.position_deg = 7.0; }},
        {Verdict::unrelated, "another joint",
         [](std::size_t, Row& row) { row.position_deg = 60 * std::sin(2.3 * row.time_s); }},
        {Verdict::unrelated, "another joint", [](std::size_t, Row& row) { row.velocity_deg_s = 0.0; }},
        {Verdict::agrees, "",
         [](std::size_t, Row& row) { row.position_deg = std::round(row.position_deg / 0.5) * 0.5; }},
        {Verdict::agrees, "",
         [](std::size_t k, Row& row) {
             if (k % 500 == 9) row.position_deg = -7e4;
         }},
        {Verdict::agrees, "",
         [](std::size_t k, Row& row) {
             if (k % 500 == 9) row.velocity_deg_s = 1e4;
         }},
        {Verdict::too_little_motion, "",
         [](std::size_t, Row& row) {
             row.position_deg *= 0.005;
             row.velocity_deg_s *= 0.005;
         }},
    };
    for (std::size_t i = 0; i < cases.size(); ++i) {
        INFO(i);
        const Recording recording = recording_of(cases[i].change);
        CHECK(recording.angle.verdict == cases[i].verdict);
        CHECK_FALSE(recording.angle.contradicted);
        CHECK_FALSE(recording.angle.reason().empty());
        if (cases[i].told.empty()) {
            CHECK(recording.warnings.empty());
        } else {
            REQUIRE(recording.warnings.size() == 1);
            CHECK_THAT(recording.warnings.front().text, Contains(cases[i].told));
        }
    }
}

TEST_CASE("what is read is the joint's angle: turned, left out, or carried on by the velocity", "[log]") {
    const Trace plain = swing([](std::size_t, Row&) {});
    const Log reversed = read_trace(swing([](std::size_t, Row& row) { row.position_deg *= -1.0; }));
    for (std::size_t k = 0; k < plain.size(); k += 100)
        CHECK(reversed.trace.position_deg[k] == plain.position_deg[k]);
    CHECK(read_trace(swing([](std::size_t, Row& row) {
              row.position_deg *= 100.0;
          })).trace.position_deg.empty());

    const Trace stops = swing([](std::size_t k, Row& row) {
        if (k >= 20000) row.position_deg = 12.0;
    });
    const Log log = read_trace(stops);
    REQUIRE(log.recording.angle.contradicted);
    const std::size_t row = log.recording.angle.contradicted->row;
    CHECK(row > 20000);
    CHECK(row < 21500);
    CHECK_THAT(log.recording.warnings.front().text, Contains(fmt::format("data row {}", row + 1)));
    CHECK(log.trace.position_deg[row - 1] == 12.0);
    for (std::size_t k = row; k < plain.size(); k += 100) {
        const double moved = log.trace.position_deg[k] - log.trace.position_deg[row];
        CHECK(moved == Approx(plain.position_deg[k] - plain.position_deg[row]).margin(0.2));
    }
}

TEST_CASE("the verdict on a position is the same whatever the blocks", "[log]") {
    const Trace trace = swing([](std::size_t k, Row& row) {
        if (k < 17000) row.velocity_deg_s = row.position_deg = 0.0;  // at rest in the opening
        row.position_deg *= 0.3;
    });
    for (const std::size_t block : {1U, 999U, 30000U}) {
        const Log log = read_trace(trace, block);
        CHECK(log.recording.angle.verdict == Verdict::scaled);
        CHECK(log.trace.position_deg.empty());
    }
}

namespace {

struct Rows {
    std::vector<double> velocity_deg_s, torque_nm, position_deg;
    [[nodiscard]] TraceView view(std::size_t first, std::size_t count) const {
        const TraceView all{{}, velocity_deg_s, velocity_deg_s, torque_nm, position_deg};
        return all.part(first, count);
    }
};

/// Every third row repeats the one before.
Rows every_third(std::size_t size) {
    std::mt19937 engine(2);
    Rows rows;
    for (std::size_t k = 0; k < size; ++k) {
        const bool repeats = k > 0 && k % 3 == 0;
        rows.velocity_deg_s.push_back(repeats ? rows.velocity_deg_s.back()
                                              : 20.0 + 0.01 * static_cast<double>(k));
        rows.torque_nm.push_back(repeats ? rows.torque_nm.back() : static_cast<double>(engine() % 1000));
    }
    return rows;
}

}  // namespace

TEST_CASE("held rows and the longest hold are the same however a log is cut into blocks", "[log]") {
    std::mt19937 engine(3);
    Rows rows = every_third(500);
    for (std::size_t k = 301; k < 305; ++k) {
        rows.velocity_deg_s[k] = rows.velocity_deg_s[300];
        rows.torque_nm[k] = rows.torque_nm[300];
    }
    HeldCounter whole;
    whole.count(rows.view(0, 500), true);
    CHECK(whole.held().longest == 5);  // rows 300 to 304 repeat row 299
    for (std::size_t i = 0; i < 50; ++i) {
        HeldCounter held;
        for (std::size_t first = 0; first < 500;) {
            const std::size_t end = std::min<std::size_t>(500, first + 1 + engine() % 40);
            held.count(rows.view(first, end - first), first == 0);
            first = end;
        }
        CHECK(held.held().count == whole.held().count);
        CHECK(held.held().longest == whole.held().longest);
    }
    HeldCounter plain;
    plain.count(every_third(500).view(0, 500), true);
    CHECK(plain.held().count == 499 / 3);
}

TEST_CASE("a torque that is held at a commanded speed counts, with and without a position", "[log]") {
    std::mt19937 engine(4);
    std::normal_distribution<double> noise;
    for (const bool position : {false, true}) {
        Rows rows;
        for (std::size_t k = 0; k < 4000; ++k) {
            rows.velocity_deg_s.push_back(60.0);
            rows.torque_nm.push_back(k % 2 == 1 ? rows.torque_nm.back() : noise(engine));
            const double now = 0.06 * static_cast<double>(k);
            if (position) rows.position_deg.push_back(k % 2 == 1 ? rows.position_deg.back() : now);
        }
        HeldCounter held;
        held.count(rows.view(0, 4000), true);
        CHECK(held.held().count == 2000);
        CHECK(held.held().longest == 1);
    }
}

TEST_CASE("the row after a gap holds nothing", "[log]") {
    Rows rows = every_third(30);
    HeldCounter held;
    held.count(rows.view(0, 15), true);
    held.count(rows.view(15, 15), true);  // row 15 repeats row 14
    CHECK(held.held().count == 8);
}

TEST_CASE("rows that are written several times are held whatever the steps of the torque", "[log]") {
    std::mt19937 engine(5);
    std::normal_distribution<double> noise;
    for (const bool position : {false, true}) {
        Rows held_rows, coarse_rows;
        for (std::size_t k = 0; k < 8000; ++k) {
            const auto updates = static_cast<double>(k - k % 4);
            held_rows.velocity_deg_s.push_back(30.0 + 0.002 * updates);
            held_rows.torque_nm.push_back(k % 4 != 0 ? held_rows.torque_nm.back()
                                                     : 0.25 * std::round(8.0 * noise(engine)));
            if (position) held_rows.position_deg.push_back(0.03 * updates);
            // Steps of the velocity and of the position, but every row measured.
            coarse_rows.velocity_deg_s.push_back(30.0 + 0.1 * std::round(0.02 * static_cast<double>(k)));
            coarse_rows.torque_nm.push_back(0.25 * std::round(noise(engine)));
            if (position) coarse_rows.position_deg.push_back(0.1 * std::round(0.3 * static_cast<double>(k)));
        }
        HeldCounter held, coarse;
        held.count(held_rows.view(0, 8000), true);
        coarse.count(coarse_rows.view(0, 8000), true);
        CHECK(held.held().count == 6000);
        CHECK(held.held().longest == 3);
        CHECK(held.held().moving == 7999);
        CHECK(coarse.held().count == 0);
    }
}

TEST_CASE("without a velocity the joint moves where its position does", "[log]") {
    std::mt19937 engine(7);
    std::normal_distribution<double> noise;
    std::vector<double> time_s, slope, torque_nm, position_deg;
    for (std::size_t k = 0; k < 8000; ++k) {
        const bool rests = k >= 4000;
        time_s.push_back(0.001 * static_cast<double>(k));
        slope.push_back(0.0);
        torque_nm.push_back(k % 4 != 0 ? torque_nm.back() : 0.25 * std::round(8.0 * noise(engine)));
        position_deg.push_back(rests ? 120.0 : 0.03 * static_cast<double>(k - k % 4));
    }
    for (const std::size_t block : {std::size_t{7}, std::size_t{8000}}) {
        HeldCounter held(true);
        const TraceView all{{}, time_s, slope, torque_nm, position_deg};
        for (std::size_t first = 0; first < 8000; first += block)
            held.count(all.part(first, std::min(block, 8000 - first)), first == 0);
        CHECK(held.held().count == 3000);
        CHECK(held.held().longest == 3);
        CHECK(held.held().moving == 4000);
    }
}
