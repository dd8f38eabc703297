// SPDX-License-Identifier: MIT
#include <algorithm>

#include "core/functions/many_numbers.hpp"
#include "model/effects.hpp"

namespace ripplenotch {
namespace {

// Places at which a screening of a log begins.
constexpr double tried_time_constants[] = {1.0, 3.0, 10.0, 30.0, 100.0, 1e5};

constexpr Parameter parameters[] = {
    {.name = "rate_nm_s",
     .unit = "Nm/s",
     .help = "slope at the beginning",
     .start = 0.01,
     .lower = -1e3,
     .upper = 1e3,
     .linear = true},
    {.name = "time_constant_s",
     .unit = "s",
     .help = "after which the slope has fallen to 37 %; the longest is a straight line in any log",
     .neutral = 1e6,
     .start = 100.0,
     .lower = 0.1,
     .upper = 1e6,
     .logarithmic = true,
     .tried = tried_time_constants},
};

constexpr LookAlike look_alikes[] = {
    {"offset", "the log is short", "a log several times as long, or one that begins after a rest"},
    {"gravity", "the log is one stroke", "coming back to the same position later"},
    {"viscous-friction", "the speed only grows or only falls", "the same speed early and late in the log"},
};

void apply(const Situation& situation, std::span<const double> values, std::span<double> torque_nm) {
    const auto& time_s = situation.motion.time_s;
    const auto exponent = [&](std::size_t k) {
        return -std::min((time_s[k] - time_s.front()) / values[1], 700.0);
    };
    with_values(torque_nm.size(), exponent, portable::many_exp,
                [&](std::size_t k, double left) { torque_nm[k] += values[0] * values[1] * (1.0 - left); });
}

}  // namespace

const Effect effects::drift{
    .name = "drift",
    .summary = "the zero of the torque sensor wanders with the clock, as it warms up",
    .equation = "torque = rate_nm_s * time_constant_s * (1 - exp(-t / time_constant_s))",
    .symptom = "a residual that follows the time of the log, at rest too, and not the motion",
    .look_alikes = look_alikes,
    .source = "the thermal response of a body of one time constant (Newton's law of cooling)",
    .side = Side::joint,
    .domain = Domain::time,
    .parameters = parameters,
    .apply = apply,
};

}  // namespace ripplenotch
