// SPDX-License-Identifier: MIT
#include "model/effects.hpp"

namespace ripplenotch {
namespace {

constexpr Parameter parameters[] = {
    {.name = "coefficient_nm_per_deg_s",
     .unit = "Nm/(deg/s)",
     .help = "friction torque per unit of speed, as the sensor sees it",
     .start = 0.005,
     .upper = 1e4,
     .linear = true},
};

constexpr LookAlike look_alikes[] = {
    {"quadratic-viscous-friction", "fewer than three speeds are in the log",
     "three speeds, the fastest five times the slowest"},
    {"coulomb-friction", "there is one speed in each direction", "two speeds in the same direction"},
    {"gravity", "the log is one smooth stroke",
     "the same positions passed at two speeds, or in both directions"},
};

void apply(const Situation& situation, std::span<const double> values, std::span<double> torque_nm) {
    for (std::size_t k = 0; k < torque_nm.size(); ++k)
        torque_nm[k] += values[0] * situation.motion.velocity_deg_s[k];
}

}  // namespace

const Effect effects::viscous_friction{
    .name = "viscous-friction",
    .summary = "friction in proportion to the speed, behind the sensor",
    .equation = "torque = coefficient_nm_per_deg_s * v",
    .symptom = "a residual in proportion to the speed, of its sign",
    .look_alikes = look_alikes,
    .source = "Olsson et al., European Journal of Control 4, 1998",
    .side = Side::joint,
    .domain = Domain::speed,
    .parameters = parameters,
    .resists = true,
    .apply = apply,
};

}  // namespace ripplenotch
