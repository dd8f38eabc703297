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

constexpr LookAlike look_alikes[] = {
    {"a wrong gain of the torque sensor", "always, unless ripple or gravity are known in Nm",
     "a known weight at rest"},
    {"load-friction", "the joint moves one way only", "a log that reverses"},
};

void apply(const Situation& situation, std::span<const double> values, std::span<double> torque_nm) {
    const double nm_per_deg_s2 = values[0] / degrees_per_radian;
    for (std::size_t k = 0; k < torque_nm.size(); ++k)
        torque_nm[k] += nm_per_deg_s2 * situation.motion.acceleration_deg_s2[k];
}

}  // namespace

const Effect effects::inertia{
    .name = "inertia",
    .summary = "torque that accelerates the link",
    .equation = "torque = inertia_kgm2 * acceleration * pi / 180",
    .symptom = "a residual in proportion to the acceleration, zero at rest and at constant speed",
    .look_alikes = look_alikes,
    .source = "Newton; Kim, Kim, Song, Trans. KSME A, 2011, eq. 4",
    .side = Side::joint,
    .domain = Domain::speed,
    .parameters = parameters,
    .bears_load = true,
    .apply = apply,
};

}  // namespace ripplenotch
