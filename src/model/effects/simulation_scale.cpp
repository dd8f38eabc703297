// SPDX-License-Identifier: MIT
#include "core/vectors/dot.hpp"
#include "model/effects.hpp"

namespace ripplenotch {
namespace {

constexpr Parameter parameters[] = {
    {.name = "error_percent",
     .unit = "%",
     .help = "by which the measured torque is larger than the simulated one",
     .start = 1.0,
     .lower = -1e4,
     .upper = 1e6,
     .linear = true},
};

constexpr LookAlike look_alikes[] = {
    {"inertia", "the simulated torque is mostly that of the inertia",
     "a log in which the joint holds a weight, or the same motion with another load"},
    {"gravity", "the joint moves slowly", "faster moves"},
    {"coulomb-friction", "the simulated torque is mostly friction", "faster moves, or another load"},
};

void apply(const Situation& situation, std::span<const double> values, std::span<double> torque_nm) {
    const auto& known_nm = situation.motion.known_nm;
    if (!known_nm.empty()) add_scaled(0.01 * values[0], known_nm.data(), torque_nm.data(), torque_nm.size());
}

}  // namespace

const Effect effects::simulation_scale{
    .name = "simulation-scale",
    .summary = "the measured torque is a multiple of the simulated one: torque constant, gear ratio or unit",
    .equation = "torque = error_percent / 100 * simulated torque",
    .symptom = "a residual in proportion to the simulated torque",
    .look_alikes = look_alikes,
    .source = "the definition of a torque constant",
    .side = Side::joint,
    .domain = Domain::time,
    .parameters = parameters,
    .bears_load = true,
    .apply = apply,
};

}  // namespace ripplenotch
