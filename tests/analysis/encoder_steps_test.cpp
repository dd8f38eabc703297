// SPDX-License-Identifier: MIT
#include <array>
#include <cmath>
#include <functional>

#include "analysis/lines/encoder.hpp"
#include "analysis/traces.hpp"
#include "ripplenotch/analysis/identification.hpp"
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
