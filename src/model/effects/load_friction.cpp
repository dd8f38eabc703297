// SPDX-License-Identifier: MIT
#include <cmath>

#include "core/functions/many_numbers.hpp"
#include "model/effects.hpp"

namespace ripplenotch {
namespace {

// Places at which a screening of a log begins.
constexpr double tried_exponents[] = {1.0};

constexpr Parameter parameters[] = {
    {.name = "torque_nm",
     .unit = "Nm",
     .help = "friction torque at a load of 1 Nm",
     .start = 0.05,
     .upper = 1e4,
     .linear = true},
    {.name = "exponent",
     .unit = "",
     .help = "how it grows with the load; 1 is in proportion",
     .neutral = 1.0,
     .start = 1.0,
     .lower = 0.2,
     .upper = 4.0,
     .tried = tried_exponents},
    width_parameter,
};

constexpr LookAlike look_alikes[] = {
    {"inertia", "the joint moves one way only", "a log that reverses"},
    {"coulomb-friction", "the load hardly changes while the joint moves",
     "moves of different acceleration, or over a larger part of the turn"},
    {"ripple-load-dependence", "the ripple is faster than the sample rate shows", "a slower move"},
};

void apply(const Situation& situation, std::span<const double> values, std::span<double> torque_nm) {
    const auto& velocity_deg_s = situation.motion.velocity_deg_s;
    const auto raise = [&](std::span<double> loads) { portable::pow(loads, values[1], loads); };
    with_two_values(
        torque_nm.size(), [&](std::size_t k) { return std::abs(situation.load_nm[k]); }, raise,
        [&](std::size_t k) { return velocity_deg_s[k] / values[2]; }, portable::many_tanh,
        [&](std::size_t k, double load, double step) { torque_nm[k] += values[0] * load * step; });
}

}  // namespace

const Effect effects::load_friction{
    .name = "load-friction",
    .summary = "friction that grows with the torque that gear and bearings carry",
    .equation =
        "torque = torque_nm * (|load| / 1 Nm)^exponent * tanh(v / width_deg_s), load = torque of inertia and "
        "gravity",
    .symptom =
        "a residual of the sign of the speed that is largest where the joint accelerates or holds a weight",
    .look_alikes = look_alikes,
    .source = "Bittencourt et al., 2010; Wolf and Iskandar, 2018",
    .side = Side::joint,
    .domain = Domain::speed,
    .parameters = parameters,
    .uses_load = true,
    .resists = true,
    .apply = apply,
};

}  // namespace ripplenotch
