// SPDX-License-Identifier: MIT
#include "model/effects.hpp"

namespace ripplenotch {
namespace {

constexpr Parameter parameters[] = {
    {.name = "inertia_kgm2",
     .unit = "kgm2",
     .help = "moment of inertia of everything behind the sensor, about the joint axis",
     .start = 1.0,
     .upper = 1e5,
     .linear = true},
};

void apply(const Motion& motion, GearRatio, std::span<const double> values, std::span<double> torque_nm) {
    const double nm_per_deg_s2 = values[0] / degrees_per_radian;
    for (std::size_t k = 0; k < torque_nm.size(); ++k)
        torque_nm[k] += nm_per_deg_s2 * motion.acceleration_deg_s2[k];
}

}  // namespace

const Effect effects::inertia{
    .name = "inertia",
    .summary = "torque that accelerates the link",
    .equation = "torque = inertia_kgm2 * acceleration * pi / 180",
    .symptom = "a residual in proportion to the acceleration, zero at rest and at constant speed",
    .look_alikes =
        "a wrong torque sensor gain, which scales ripple and gravity as well; load-friction when the joint "
        "moves one way only",
    .source = "Newton; Kim, Kim, Song, Trans. KSME A, 2011, eq. 4",
    .side = Side::joint,
    .parameters = parameters,
    .apply = apply,
};

}  // namespace ripplenotch
