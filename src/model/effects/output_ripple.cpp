// SPDX-License-Identifier: MIT
#include "model/effects.hpp"
#include "model/evaluate.hpp"

namespace ripplenotch {
namespace {

// Places at which a screening of a log begins.
constexpr double tried_orders[] = {2.0, 3.0, 4.0, 5.0, 6.0};

constexpr Parameter parameters[] = {
    cycles_parameter("order", "cycles per output revolution", 2.0, 1e5, tried_orders),
    cosine_amplitude_parameter,
    cosine_phase_parameter,
};

constexpr LookAlike look_alikes[] = {
    {"gravity", "the order is 2 and the travel is below half a turn",
     "a travel of a whole output revolution"},
    {"ripple", "the order is near a multiple of the gear ratio", "a travel of several output revolutions"},
    {"offset", "the travel is a small part of a cycle", "a travel of a whole output revolution"},
};

void apply(const Situation& situation, std::span<const double> values, std::span<double> torque_nm) {
    const auto& position_deg = situation.motion.position_deg;
    with_cosines(
        torque_nm.size(), [&](std::size_t k) { return values[0] * position_deg[k] + values[2]; },
        [&](std::size_t k, double cosine) { torque_nm[k] += values[1] * cosine; });
}

}  // namespace

const Effect effects::output_ripple{
    .name = "output-ripple",
    .summary =
        "torque that repeats with the output angle: misalignment, crosstalk of the sensor, a bearing behind "
        "the gear",
    .equation = "torque = amplitude_nm * cos(order * q + phase_deg)",
    .symptom = "the same torque at the same position in both directions, order cycles per output revolution",
    .look_alikes = look_alikes,
    .source =
        "Taghirad and Belanger, 1998, for misalignment; Godler et al., 1999, for the placing of the gauges",
    .side = Side::joint,
    .domain = Domain::position,
    .parameters = parameters,
    .polar = Polar{1, 2},
    .apply = apply,
};

}  // namespace ripplenotch
