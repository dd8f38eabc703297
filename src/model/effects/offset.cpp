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

constexpr LookAlike look_alikes[] = {
    {"coulomb-friction", "the joint moves one way only and never rests", "a log that reverses, or rests"},
    {"gravity", "the travel is small", "a travel of half a turn"},
    {"drift", "the log is short", "a log several times as long"},
};

void apply(const Situation&, std::span<const double> values, std::span<double> torque_nm) {
    for (double& torque : torque_nm) torque += values[0];
}

}  // namespace

const Effect effects::offset{
    .name = "offset",
    .summary = "zero error of the torque sensor",
    .equation = "torque = torque_nm",
    .symptom = "a residual of the same size and sign everywhere, at rest too",
    .look_alikes = look_alikes,
    .source = "the definition of a strain gauge bridge's zero",
    .side = Side::joint,
    .domain = Domain::time,
    .parameters = parameters,
    .apply = apply,
};

}  // namespace ripplenotch
