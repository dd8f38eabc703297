// SPDX-License-Identifier: MIT
#include "model/effects.hpp"
#include "model/evaluate.hpp"

namespace ripplenotch {
namespace {

// Places at which a screening of a log begins.
constexpr double tried_orders[] = {1.0, 2.0, 3.0};

constexpr Parameter parameters[] = {
    cycles_parameter("output_order", "cycles of the modulation per output revolution", 1.0, 1e4,
                     tried_orders),
    {.name = "depth_percent",
     .unit = "%",
     .help = "zero to peak, of the size of the ripple",
     .start = 30.0,
     .upper = 1000.0,
     .linear = true},
    cosine_phase_parameter,
    ripple_order_parameter,
};

constexpr LookAlike look_alikes[] = {
    {"gear-ratio", "the joint turns less than a revolution", "a travel of a whole output revolution"},
    {"ripple-load-dependence", "gravity makes the load follow the position",
     "the same positions with another load"},
};

void change_ripple(const Situation& situation, Order order, std::span<const double> values,
                   std::span<std::complex<double>> gain) {
    if (!concerns(order, values[3])) return;
    const auto& position_deg = situation.motion.position_deg;
    with_cosines(
        gain.size(), [&](std::size_t k) { return values[0] * position_deg[k] + values[2]; },
        [&](std::size_t k, double cosine) { gain[k] *= 1.0 + 0.01 * values[1] * cosine; });
}

}  // namespace

const Effect effects::ripple_modulation{
    .name = "ripple-modulation",
    .summary =
        "ripple whose size swells and fades with the output angle: an eccentric or tilted circular spline",
    .equation = "ripple amplitude * (1 + depth_percent / 100 * cos(output_order * q + phase_deg))",
    .symptom = "sidebands of each line of the ripple, output_order cycles per output revolution away",
    .look_alikes = look_alikes,
    .source =
        "amplitude modulation; Tuttle, 1992, and Taghirad and Belanger, 1998, for dissipation and torque "
        "that change over the output turn",
    .side = Side::ripple,
    .domain = Domain::order,
    .parameters = parameters,
    .polar = Polar{1, 2},
    .change_ripple = change_ripple,
};

}  // namespace ripplenotch
