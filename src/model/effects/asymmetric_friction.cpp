// SPDX-License-Identifier: MIT
#include "core/functions/many_numbers.hpp"
#include "model/effects.hpp"

namespace ripplenotch {
namespace {

constexpr Parameter parameters[] = {
    {.name = "difference_nm",
     .unit = "Nm",
     .help = "friction torque in positive motion less that in negative motion",
     .start = 0.3,
     .lower = -1e5,
     .upper = 1e5,
     .linear = true},
    {.name = "width_deg_s",
     .unit = "deg/s",
     .help = "speed at which 58 % of it has built up",
     .neutral = 0.2,
     .start = 0.2,
     .lower = 0.001,
     .upper = 100.0,
     .logarithmic = true,
     .left_out = LeftOut::assumed},
};

constexpr LookAlike look_alikes[] = {
    {"coulomb-friction", "the joint moves one way only", "a log that reverses, and rests"},
    {"offset", "the joint never rests, or all rests are short",
     "reversals, and standstill of a second or more: an offset stays at rest, a difference of friction does "
     "not"},
    {"gravity", "the travel is a small part of a turn, or a direction goes with a range of positions",
     "the same positions passed in both directions, and standstill at several positions"},
    {"quadratic-viscous-friction", "the joint moves one way only", "a log that reverses"},
};

void apply(const Situation& situation, std::span<const double> values, std::span<double> torque_nm) {
    const auto& velocity_deg_s = situation.motion.velocity_deg_s;
    with_values(
        torque_nm.size(), [&](std::size_t k) { return velocity_deg_s[k] / values[1]; }, portable::many_tanh,
        [&](std::size_t k, double step) { torque_nm[k] += 0.5 * values[0] * step * step; });
}

}  // namespace

const Effect effects::asymmetric_friction{
    .name = "asymmetric-friction",
    .summary = "Coulomb friction whose level differs between the two directions of motion",
    .equation = "torque = difference_nm / 2 * tanh(v / width_deg_s)^2",
    .symptom = "an offset in the residual that is the same in both directions of motion and absent at rest",
    .look_alikes = look_alikes,
    .source =
        "Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30, 1994, for friction that depends on the "
        "direction",
    .side = Side::joint,
    .domain = Domain::speed,
    .parameters = parameters,
    .apply = apply,
};

}  // namespace ripplenotch
