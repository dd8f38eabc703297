// SPDX-License-Identifier: MIT
#include <cmath>

#include "model/effects.hpp"

namespace ripplenotch {
namespace {

constexpr Parameter parameters[] = {
    {.name = "coefficient_nm_per_deg2_s2",
     .unit = "Nm/(deg/s)2",
     .help = "friction torque per square of the speed; below 0 together with viscous-friction, for friction "
             "that saturates",
     .start = 1e-5,
     .lower = -1e3,
     .upper = 1e3,
     .linear = true},
};

constexpr LookAlike look_alikes[] = {
    {"viscous-friction", "fewer than three speeds are in the log",
     "three speeds, the fastest five times the slowest"},
    {"gravity", "the log is one smooth stroke",
     "the same positions passed at two speeds, or in both directions"},
};

void apply(const Situation& situation, std::span<const double> values, std::span<double> torque_nm) {
    for (std::size_t k = 0; k < torque_nm.size(); ++k) {
        const double v = situation.motion.velocity_deg_s[k];
        torque_nm[k] += values[0] * v * std::abs(v);
    }
}

}  // namespace

const Effect effects::quadratic_viscous_friction{
    .name = "quadratic-viscous-friction",
    .summary = "friction that grows with the square of the speed",
    .equation = "torque = coefficient_nm_per_deg2_s2 * v * |v|",
    .symptom = "a residual that curves with the speed, of its sign",
    .look_alikes = look_alikes,
    .source =
        "windage and churning of grease; Bittencourt et al., 2010, for friction that is not in proportion to "
        "the speed",
    .side = Side::joint,
    .domain = Domain::speed,
    .parameters = parameters,
    .apply = apply,
};

}  // namespace ripplenotch
