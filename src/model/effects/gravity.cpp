// SPDX-License-Identifier: MIT
#include "model/effects.hpp"
#include "model/evaluate.hpp"

namespace ripplenotch {
namespace {

constexpr Parameter parameters[] = {
    {.name = "amplitude_nm",
     .unit = "Nm",
     .help = "mass * 9.81 m/s2 * distance of the centre of mass from the axis * cosine of the axis' tilt",
     .start = 1.0,
     .upper = 1e5,
     .linear = true},
    {.name = "phase_deg",
     .unit = "deg",
     .help = "angle of the centre of mass above the horizontal where the joint's position is zero",
     .lower = -360.0,
     .upper = 360.0},
};

constexpr LookAlike look_alikes[] = {
    {"crosstalk of the sensor, once per output revolution", "always",
     "a second mounting of the joint; no log of one mounting distinguishes them"},
    {"offset", "the travel is below 30 deg", "a travel of half a turn"},
    {"quadratic-viscous-friction", "the log is one smooth stroke",
     "the same positions passed at two speeds, or in both directions"},
    {"drift", "the log is one stroke", "coming back to the same position later"},
};

void apply(const Situation& situation, std::span<const double> values, std::span<double> torque_nm) {
    const auto& position_deg = situation.motion.position_deg;
    with_cosines(
        torque_nm.size(), [&](std::size_t k) { return position_deg[k] + values[1]; },
        [&](std::size_t k, double cosine) { torque_nm[k] += values[0] * cosine; });
}

}  // namespace

const Effect effects::gravity{
    .name = "gravity",
    .summary = "weight of the link about a joint axis that is not vertical",
    .equation = "torque = amplitude_nm * cos(q + phase_deg)",
    .symptom =
        "the same torque at the same position in both directions, at rest too; one cycle per output "
        "revolution",
    .look_alikes = look_alikes,
    .source = "statics; Taghirad and Belanger, 1998, for the crosstalk",
    .side = Side::joint,
    .domain = Domain::position,
    .parameters = parameters,
    .polar = Polar{0, 1},
    .bears_load = true,
    .apply = apply,
};

}  // namespace ripplenotch
