// SPDX-License-Identifier: MIT
#include "model/effects.hpp"
#include "ripplenotch/core/portable_math.hpp"

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
    if (situation.ripple_gain.empty()) {
        for (std::size_t k = 0; k < torque_nm.size(); ++k)
            torque_nm[k] +=
                amplitude_nm * portable::cos_degrees(cycles_per_turn * position_deg[k] + phase_deg);
        return;
    }
    for (std::size_t k = 0; k < torque_nm.size(); ++k) {
        const double angle_deg = cycles_per_turn * position_deg[k] + phase_deg;
        const auto gain = situation.ripple_gain[k];
        const double along = gain.real() * portable::cos_degrees(angle_deg);
        // Most changes of the ripple leave its phase as it is.
        const double across = gain.imag() != 0.0 ? gain.imag() * portable::sin_degrees(angle_deg) : 0.0;
        torque_nm[k] += amplitude_nm * (along - across);
    }
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
