// SPDX-License-Identifier: MIT
#include <cmath>

#include "core/many_numbers.hpp"
#include "model/effects.hpp"

namespace ripplenotch {
namespace {

// Places at which a screening of a log begins.
constexpr double tried_exponents[] = {0.5, 1.0, 2.0};

constexpr Parameter parameters[] = {
    {.name = "gain_percent",
     .unit = "%",
     .help = "by which the ripple is larger at 100 deg/s than at rest",
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
};

constexpr LookAlike look_alikes[] = {
    {"resonance", "its frequency is above the fastest ripple",
     "a faster move: a resonance turns the phase as well"},
    {"lag", "the ripple falls with the speed",
     "inertia torque and ripple in the same log: a lag delays both"},
    {"ripple-load-dependence", "the log is one smooth stroke",
     "the same speed with and without acceleration"},
};

void change_ripple(const Situation& situation, Order order, std::span<const double> values,
                   std::span<std::complex<double>> gain) {
    if (!concerns(order, values[2])) return;
    const auto speed = [&](std::size_t k) { return std::abs(situation.motion.velocity_deg_s[k]) / 100.0; };
    const auto raise = [&](std::span<double> speeds) { portable::pow(speeds, values[1], speeds); };
    with_values(gain.size(), speed, raise,
                [&](std::size_t k, double growth) { gain[k] *= 1.0 + 0.01 * values[0] * growth; });
}

}  // namespace

const Effect effects::ripple_speed_dependence{
    .name = "ripple-speed-dependence",
    .summary = "ripple whose size changes with the speed",
    .equation = "ripple amplitude * (1 + gain_percent / 100 * (|v| / 100 deg/s)^exponent)",
    .symptom = "lines of the ripple in the residual that grow, or change sign, with the speed",
    .look_alikes = look_alikes,
    .source =
        "measured harmonic drives, whose ripple changes up to eightfold over the speed range; Taghirad and "
        "Belanger, 1998",
    .side = Side::ripple,
    .domain = Domain::order,
    .parameters = parameters,
    .change_ripple = change_ripple,
};

}  // namespace ripplenotch
