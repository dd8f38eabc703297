// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "core/functions/many_numbers.hpp"
#include "model/effects.hpp"

namespace ripplenotch {
namespace {

// Places at which a screening of a log begins.
constexpr double tried_speeds[] = {3.0, 5.0, 8.0, 12.0, 18.0, 30.0, 60.0};

constexpr Parameter parameters[] = {
    {.name = "torque_nm",
     .unit = "Nm",
     .help = "friction torque just above standstill, beyond what is there at speed",
     .start = 0.5,
     .upper = 1e5,
     .linear = true},
    {.name = "stribeck_speed_deg_s",
     .unit = "deg/s",
     .help = "speed at which 37 % of it remains",
     .neutral = 10.0,
     .start = 10.0,
     .lower = 0.05,
     .upper = 1000.0,
     .logarithmic = true,
     .tried = tried_speeds},
    width_parameter,
};

constexpr LookAlike look_alikes[] = {
    {"coulomb-friction", "no sample moves slower than the Stribeck speed, or none faster",
     "passes at several speeds from a tenth of the Stribeck speed to ten times it"},
    {"start-stop-ringing", "every slow sample belongs to a start or a stop", "a long pass at low speed"},
    {"hysteresis", "every slow sample belongs to a reversal", "a long pass at low speed"},
};

void apply(const Situation& situation, std::span<const double> values, std::span<double> torque_nm) {
    const auto& velocity_deg_s = situation.motion.velocity_deg_s;
    const auto exponent = [&](std::size_t k) {
        const double relative = std::min(std::abs(velocity_deg_s[k]) / values[1], 26.0);
        return -relative * relative;
    };
    with_two_values(
        torque_nm.size(), [&](std::size_t k) { return velocity_deg_s[k] / values[2]; }, portable::many_tanh,
        exponent, portable::many_exp,
        [&](std::size_t k, double step, double left) { torque_nm[k] += values[0] * step * left; });
}

}  // namespace

const Effect effects::stribeck_friction{
    .name = "stribeck-friction",
    .summary = "static friction: more torque to move slowly than to move",
    .equation = "torque = torque_nm * tanh(v / width_deg_s) * exp(-(v / stribeck_speed_deg_s)^2)",
    .symptom = "a residual of the sign of the speed, at low speed only: at both ends of a move",
    .look_alikes = look_alikes,
    .source =
        "Stribeck, 1902; Olsson et al., European Journal of Control 4, 1998; both ends of the move in Kim, "
        "Kim, Song, Trans. KSME A, 2011, fig. 11",
    .side = Side::joint,
    .domain = Domain::speed,
    .parameters = parameters,
    .resists = true,
    .apply = apply,
};

}  // namespace ripplenotch
