// SPDX-License-Identifier: MIT
#include "core/functions/many_numbers.hpp"
#include "model/effects.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

// Places at which a screening of a log begins.
constexpr double tried_orders[] = {1.0, 2.0};

// A log of one direction shows no friction by position but a ripple.
constexpr Parameter order_parameter() {
    Parameter order = cycles_parameter("order", "cycles per output revolution", 1.0, 1e4, tried_orders);
    order.hint = Hint::both_ways;
    return order;
}

constexpr Parameter parameters[] = {
    order_parameter(),
    cosine_amplitude_parameter,
    cosine_phase_parameter,
    width_parameter,
};

constexpr LookAlike look_alikes[] = {
    {"coulomb-friction", "the travel is a small part of a cycle", "a travel of a whole output revolution"},
    {"output-ripple", "each position is passed in one direction only",
     "the same positions in both directions: ripple keeps its sign, friction does not"},
    {"gravity", "each position is passed in one direction only",
     "the same positions in both directions, and standstill at several positions"},
    {"load-friction", "gravity makes the load follow the position", "the same positions with another load"},
};

void cosines(std::span<double> angles_deg) { portable::cos_degrees(angles_deg, angles_deg); }

void apply(const Situation& situation, std::span<const double> values, std::span<double> torque_nm) {
    const Motion& motion = situation.motion;
    with_two_values(
        torque_nm.size(), [&](std::size_t k) { return values[0] * motion.position_deg[k] + values[2]; },
        cosines, [&](std::size_t k) { return motion.velocity_deg_s[k] / values[3]; }, portable::many_tanh,
        [&](std::size_t k, double cosine, double step) { torque_nm[k] += values[1] * cosine * step; });
}

}  // namespace

const Effect effects::position_dependent_friction{
    .name = "position-dependent-friction",
    .summary = "Coulomb friction that changes with the output angle: misalignment or uneven preload",
    .equation = "torque = amplitude_nm * cos(order * q + phase_deg) * tanh(v / width_deg_s)",
    .symptom =
        "a residual at the same positions in both directions with opposite sign, order cycles per output "
        "revolution",
    .look_alikes = look_alikes,
    .source =
        "Popovic and Goldenberg, IEEE Transactions on Robotics and Automation 14, 1998; Armstrong, 1988, for "
        "friction by position",
    .side = Side::joint,
    .domain = Domain::position,
    .parameters = parameters,
    .polar = Polar{1, 2},
    .apply = apply,
};

}  // namespace ripplenotch
