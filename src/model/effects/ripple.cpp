// SPDX-License-Identifier: MIT
#include "model/effects.hpp"
#include "model/evaluate.hpp"

namespace ripplenotch {
namespace {

// Places at which a screening of a log begins.
constexpr double tried_orders[] = {0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 10.0, 12.0};

constexpr Parameter parameters[] = {
    cycles_parameter("order", "cycles per motor revolution", 1.0, 1000.0, tried_orders),
    cosine_amplitude_parameter,
    cosine_phase_parameter,
};

constexpr LookAlike look_alikes[] = {
    {"tone", "the log has one speed only", "a second speed: an order moves with it, a tone stays"},
    {"ripple-modulation", "the joint turns less than half a revolution",
     "a travel of a whole output revolution"},
    {"gear-ratio", "the joint turns less than half a revolution", "a travel of a whole output revolution"},
};

void apply(const Situation& situation, std::span<const double> values, std::span<double> torque_nm) {
    const double cycles_per_turn = values[0] * situation.ratio.value();
    const double amplitude_nm = values[1], phase_deg = values[2];
    const auto& position_deg = situation.motion.position_deg;
    const auto angle_deg = [&](std::size_t k) { return cycles_per_turn * position_deg[k] + phase_deg; };
    const auto gain = situation.ripple_gain;
    if (gain.empty()) {
        with_cosines(torque_nm.size(), angle_deg,
                     [&](std::size_t k, double cosine) { torque_nm[k] += amplitude_nm * cosine; });
        return;
    }
    with_cosines_and_sines(torque_nm.size(), angle_deg, [&](std::size_t k, double cosine, double sine) {
        torque_nm[k] += amplitude_nm * (gain[k].real() * cosine - gain[k].imag() * sine);
    });
}

}  // namespace

const Effect effects::ripple{
    .name = "ripple",
    .summary = "torque ripple of the harmonic drive, locked to the motor angle",
    .equation = "torque = amplitude_nm * cos(order * gear_ratio * q + phase_deg)",
    .symptom = "a line at f = order * gear_ratio * |v| / 360 that moves in proportion to the speed",
    .look_alikes = look_alikes,
    .source = "Kim, Kim, Song, Trans. KSME A, 2011, eq. 1 and 3; Taghirad and Belanger, 1998",
    .side = Side::joint,
    .domain = Domain::order,
    .parameters = parameters,
    .polar = Polar{1, 2},
    .ripple_order = 0,
    .apply = apply,
};

}  // namespace ripplenotch
