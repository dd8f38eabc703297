// SPDX-License-Identifier: MIT
#include <cmath>

#include "model/effects.hpp"

namespace ripplenotch {
namespace {

constexpr Parameter parameters[] = {
    {.name = "difference_nm_per_deg_s",
     .unit = "Nm/(deg/s)",
     .help = "viscous friction coefficient in positive motion less that in negative motion",
     .start = 0.002,
     .lower = -1e4,
     .upper = 1e4,
     .linear = true},
};

constexpr LookAlike look_alikes[] = {
    {"asymmetric-friction", "there is one speed in each direction",
     "two speeds in each direction, the fastest five times the slowest"},
    {"offset", "the joint never rests, and has one speed in each direction",
     "standstill, or two speeds in each direction"},
    {"viscous-friction", "the joint moves one way only", "a log that reverses"},
    {"quadratic-viscous-friction", "the joint moves one way only", "a log that reverses, at three speeds"},
    {"gravity", "the log is one smooth stroke",
     "the same positions passed at two speeds, or in both directions"},
};

void apply(const Situation& situation, std::span<const double> values, std::span<double> torque_nm) {
    for (std::size_t k = 0; k < torque_nm.size(); ++k)
        torque_nm[k] += 0.5 * values[0] * std::abs(situation.motion.velocity_deg_s[k]);
}

}  // namespace

const Effect effects::asymmetric_viscous_friction{
    .name = "asymmetric-viscous-friction",
    .summary = "viscous friction whose coefficient differs between the two directions of motion",
    .equation = "torque = difference_nm_per_deg_s / 2 * |v|",
    .symptom = "a residual in proportion to the speed, of the same sign in both directions of motion",
    .look_alikes = look_alikes,
    .source =
        "Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30, 1994, for friction that depends on the "
        "direction; Janot, Gautier, Brunot, 2019, for a linear axis that has it (EMPS)",
    .side = Side::joint,
    .domain = Domain::speed,
    .parameters = parameters,
    .differs = true,
    .apply = apply,
};

}  // namespace ripplenotch
