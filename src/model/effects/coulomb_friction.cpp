// SPDX-License-Identifier: MIT
#include "core/functions/many_numbers.hpp"
#include "model/effects.hpp"

namespace ripplenotch {
namespace {

// Places at which a screening of a log begins.
constexpr double tried_widths[] = {0.2, 2.0};

constexpr Parameter parameters[] = {
    {.name = "torque_nm",
     .unit = "Nm",
     .help = "friction torque while the joint moves, as the sensor sees it",
     .start = 0.5,
     .upper = 1e5,
     .linear = true},
    {.name = "width_deg_s",
     .unit = "deg/s",
     .help = "speed at which 76 % of it has built up; logs of steady motion do not determine it",
     .neutral = 0.2,
     .start = 0.2,
     .lower = 0.001,
     .upper = 100.0,
     .logarithmic = true,
     .tried = tried_widths},
};

constexpr LookAlike look_alikes[] = {
    {"offset", "the joint moves one way only and never rests", "a log that reverses, or rests"},
    {"hysteresis", "every reversal is quick",
     "slow reversals: hysteresis builds up over an angle, Coulomb friction at once"},
    {"viscous-friction", "there is one speed in each direction", "two speeds in the same direction"},
};

void apply(const Situation& situation, std::span<const double> values, std::span<double> torque_nm) {
    const auto& velocity_deg_s = situation.motion.velocity_deg_s;
    with_values(
        torque_nm.size(), [&](std::size_t k) { return velocity_deg_s[k] / values[1]; }, portable::many_tanh,
        [&](std::size_t k, double step) { torque_nm[k] += values[0] * step; });
}

}  // namespace

const Effect effects::coulomb_friction{
    .name = "coulomb-friction",
    .summary = "friction of constant size against the motion, behind the sensor",
    .equation = "torque = torque_nm * tanh(v / width_deg_s)",
    .symptom = "a residual that changes sign with the direction of motion and does not depend on the speed",
    .look_alikes = look_alikes,
    .source = "Coulomb; Olsson et al., European Journal of Control 4, 1998, for the smoothed form",
    .side = Side::joint,
    .domain = Domain::speed,
    .parameters = parameters,
    .resists = true,
    .apply = apply,
};

}  // namespace ripplenotch
