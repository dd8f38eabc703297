// SPDX-License-Identifier: MIT
#include "model/effects.hpp"
#include "model/reproducible.hpp"

namespace ripplenotch {
namespace {

constexpr Parameter parameters[] = {
    {.name = "order",
     .unit = "",
     .help = "cycles per motor revolution",
     .neutral = 1.0,
     .start = 1.0,
     .lower = 0.01,
     .upper = 1000.0},
    {.name = "amplitude_nm",
     .unit = "Nm",
     .help = "zero to peak",
     .start = 0.5,
     .upper = 1e5,
     .linear = true},
    {.name = "phase_deg",
     .unit = "deg",
     .help = "phase of the cosine where the joint's position is zero",
     .lower = -360.0,
     .upper = 360.0},
};

void apply(const Motion& motion, GearRatio ratio, std::span<const double> values,
           std::span<double> torque_nm) {
    const double cycles_per_turn = values[0] * ratio.value();
    const double amplitude_nm = values[1], phase_deg = values[2];
    for (std::size_t k = 0; k < torque_nm.size(); ++k) {
        torque_nm[k] += amplitude_nm * cos_degrees(cycles_per_turn * motion.position_deg[k] + phase_deg);
    }
}

}  // namespace

const Effect effects::ripple{
    .name = "ripple",
    .summary = "torque ripple of the harmonic drive, locked to the motor angle",
    .equation = "torque = amplitude_nm * cos(order * gear_ratio * q + phase_deg)",
    .symptom = "a line at f = order * gear_ratio * |v| / 360 that moves in proportion to the speed",
    .look_alikes =
        "a tone of fixed frequency when the log has one speed only; ripple-modulation or a wrong gear ratio "
        "when the joint turns less than half a revolution",
    .source = "Kim, Kim, Song, Trans. KSME A, 2011, eq. 1 and 3; Taghirad and Belanger, 1998",
    .side = Side::joint,
    .parameters = parameters,
    .apply = apply,
};

}  // namespace ripplenotch
