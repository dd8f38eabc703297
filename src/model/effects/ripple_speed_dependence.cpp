// SPDX-License-Identifier: MIT
#include <cmath>

#include "core/functions/many_numbers.hpp"
#include "model/effects.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

// Places at which a screening of a log begins.
constexpr double tried_exponents[] = {0.5, 1.0, 2.0};

constexpr Parameter parameters[] = {
    {.name = "gain_percent",
     .unit = "%",
     .help =
         "by which the ripple is larger at 100 deg/s than at rest; with from_deg_s: which part of the ripple "
         "at that speed is gone at rest",
     .start = 30.0,
     .lower = -1000.0,
     .upper = 1e6,
     .linear = true},
    {.name = "exponent",
     .unit = "",
     .help = "how it grows with the speed; 1 is in proportion",
     .neutral = 1.0,
     .start = 1.0,
     .lower = 0.1,
     .upper = 4.0,
     .tried = tried_exponents},
    ripple_order_parameter,
    {.name = "from_deg_s",
     .unit = "deg/s",
     .help = "speed at which the ripple has the amplitude of its term; below 0.001 at rest",
     .upper = 1e5,
     .left_out = LeftOut::assumed},
};
constexpr std::size_t from_place = 3;         // index of from_deg_s in the list above
constexpr double slowest_from_deg_s = 0.001;  // chosen, not derived: slower is standstill

constexpr LookAlike look_alikes[] = {
    {"resonance", "its frequency is above the fastest ripple",
     "a faster move: a resonance turns the phase as well"},
    {"lag", "the ripple falls with the speed",
     "inertia torque and ripple in the same log: a lag delays both"},
    {"ripple-load-dependence", "the log is one smooth stroke",
     "the same speed with and without acceleration"},
};

bool is_from_rest(double from_deg_s) { return from_deg_s < slowest_from_deg_s; }

// 1 + gain * growth, or in its other form 1 + gain * (growth - 1).
struct Line {
    double at_rest, growth, unit_deg_s;
};

Line line_of(std::span<const double> values) {
    const double growth = 0.01 * values[0], from_deg_s = values[from_place];
    if (is_from_rest(from_deg_s)) return {1.0, growth, 100.0};
    return {1.0 - growth, growth, from_deg_s};
}

void change_ripple(const Situation& situation, Order order, std::span<const double> values,
                   std::span<std::complex<double>> gain) {
    if (!concerns(order, values[2])) return;
    const Line line = line_of(values);
    const auto speed = [&](std::size_t k) {
        return std::abs(situation.motion.velocity_deg_s[k]) / line.unit_deg_s;
    };
    const auto raise = [&](std::span<double> speeds) { portable::pow(speeds, values[1], speeds); };
    with_values(gain.size(), speed, raise,
                [&](std::size_t k, double grown) { gain[k] *= line.at_rest + line.growth * grown; });
}

double restate(double from_deg_s, std::span<double> values) {
    const Line line = line_of(values);
    const double unit_deg_s = is_from_rest(from_deg_s) ? 100.0 : from_deg_s;
    const double growth = line.growth * portable::pow(unit_deg_s / line.unit_deg_s, values[1]);
    const double there = is_from_rest(from_deg_s) ? line.at_rest : line.at_rest + growth;
    values[0] = 100.0 * growth / there;
    values[from_place] = from_deg_s;
    return there;
}

}  // namespace

const Effect effects::ripple_speed_dependence{
    .name = "ripple-speed-dependence",
    .summary = "ripple whose size changes with the speed",
    .equation =
        "ripple amplitude * (1 + gain_percent / 100 * (|v| / 100 deg/s)^exponent); with from_deg_s: "
        "ripple amplitude * (1 + gain_percent / 100 * ((|v| / from_deg_s)^exponent - 1))",
    .symptom = "lines of the ripple in the residual that grow, or change sign, with the speed",
    .look_alikes = look_alikes,
    .source =
        "measured harmonic drives, whose ripple changes up to eightfold over the speed range; Taghirad and "
        "Belanger, 1998",
    .side = Side::ripple,
    .domain = Domain::order,
    .parameters = parameters,
    .stated_from = from_place,
    .change_ripple = change_ripple,
    .restate = restate,
};

}  // namespace ripplenotch
