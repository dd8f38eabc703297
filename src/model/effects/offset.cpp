// SPDX-License-Identifier: MIT
#include "model/effects.hpp"

namespace ripplenotch {
namespace {

constexpr Parameter parameters[] = {
    {.name = "torque_nm",
     .unit = "Nm",
     .help = "what the sensor shows when there is no torque",
     .lower = -1e5,
     .upper = 1e5,
     .linear = true},
};

void apply(const Motion&, GearRatio, std::span<const double> values, std::span<double> torque_nm) {
    for (double& torque : torque_nm) torque += values[0];
}

}  // namespace

const Effect effects::offset{
    .name = "offset",
    .summary = "zero error of the torque sensor",
    .equation = "torque = torque_nm",
    .symptom = "a residual of the same size and sign everywhere, at rest too",
    .look_alikes =
        "coulomb-friction when the joint moves one way only and never rests; gravity over a small travel; "
        "drift in a short log",
    .source = "the definition of a strain gauge bridge's zero",
    .side = Side::joint,
    .parameters = parameters,
    .apply = apply,
};

}  // namespace ripplenotch
