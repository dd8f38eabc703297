// SPDX-License-Identifier: MIT
// Is a position this joint's? By scale, sign, wrap and standing still; and where the log contradicts itself.
#include <cmath>
#include <functional>
#include <random>

#include "log_support.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::Contains;
using test::read_trace;
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
