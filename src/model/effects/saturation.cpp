// SPDX-License-Identifier: MIT
#include <algorithm>

#include "model/effects.hpp"

namespace ripplenotch {
namespace {

constexpr Parameter parameters[] = {
    {.name = "limit_nm",
     .unit = "Nm",
     .help = "largest torque that is logged; at the upper bound there is no limit",
     .neutral = 1e6,
     .start = 2.0,
     .lower = 0.0,
     .upper = 1e6},
};

constexpr LookAlike look_alikes[] = {
    {"rest on a coarse quantization", "the torque rests at its extreme",
     "a finer log; clipped samples lie at both ends of the range"},
};

void apply(const Situation&, std::span<const double> values, std::span<double> torque_nm) {
    for (std::size_t k = 0; k < torque_nm.size(); ++k)
        torque_nm[k] = std::clamp(torque_nm[k], -values[0], values[0]);
}

}  // namespace

const Effect effects::saturation{
    .name = "saturation",
    .summary = "the sensor or its converter clips",
    .equation = "logged torque = torque, or -limit_nm or limit_nm where it is beyond",
    .symptom = "runs of samples at exactly the largest value of the log",
    .look_alikes = look_alikes,
    .source = "the range of an amplifier",
    .side = Side::converter,
    .domain = Domain::time,
    .parameters = parameters,
    .linear_in_torque = false,
    .apply = apply,
};

}  // namespace ripplenotch
