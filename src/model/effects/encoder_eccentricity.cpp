// SPDX-License-Identifier: MIT
#include "model/effects.hpp"
#include "model/evaluate.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

// Places at which a screening of a log begins.
constexpr double tried_orders[] = {1.0, 2.0};
constexpr double tried_amplitudes[] = {0.03, 0.1, 0.3};
constexpr double tried_phases[] = {-90.0, 0.0, 90.0, 180.0};

constexpr Parameter parameters[] = {
    cycles_parameter("order", "cycles of the error per output revolution", 1.0, 1e3, tried_orders),
    {.name = "amplitude_deg",
     .unit = "deg",
     .help = "error of the angle on the output side, zero to peak",
     .start = 0.1,
     .upper = 10.0,
     .tried = tried_amplitudes},
    {.name = "phase_deg",
     .unit = "deg",
     .help = "phase of the cosine where the position of the log is zero",
     .lower = -360.0,
     .upper = 360.0,
     .tried = tried_phases},
};

constexpr LookAlike look_alikes[] = {
    {"ripple-modulation", "the log passes few cycles of the error",
     "a travel of two output revolutions: an error of the angle shifts the phase of the ripple, a modulation "
     "its amplitude"},
    {"gear-ratio", "the travel is a small part of a cycle", "a travel of a whole output revolution"},
    {"velocity-bias", "the joint turns at one speed in one direction",
     "strokes in both directions: the phase error of an encoder returns, that of a bias grows on"},
    {"a kinematic error of the gear, once or twice per output revolution", "always",
     "a second encoder on the output"},
};

void change_motion(std::span<const double> values, Motion& motion, GearRatio&) {
    const double order = values[0], amplitude_deg = values[1], phase_deg = values[2];
    if (amplitude_deg == 0.0) return;
    const double per_deg = order / degrees_per_radian;
    with_cosines_and_sines(
        motion.size(), [&](std::size_t k) { return order * motion.position_deg[k] + phase_deg; },
        [&](std::size_t k, double cosine, double sine) {
            double& v = motion.velocity_deg_s[k];
            double& a = motion.acceleration_deg_s2[k];
            motion.position_deg[k] -= amplitude_deg * cosine;
            a += amplitude_deg * per_deg * (sine * a + per_deg * cosine * v * v);
            v += amplitude_deg * per_deg * sine * v;
        });
}

}  // namespace

const Effect effects::encoder_eccentricity{
    .name = "encoder-eccentricity",
    .summary = "the angle of the log errs with the output angle: an eccentric or tilted encoder disc",
    .equation =
        "q - amplitude_deg * cos(order * q + phase_deg) replaces q, and its derivatives those of v and dv/dt",
    .symptom = "lines of the ripple in the residual whose phase error comes and goes with the output angle",
    .look_alikes = look_alikes,
    .source =
        "Ellin and Dolsak, Sensor Review 28, 2008, for eccentric discs; the derivatives by the chain rule",
    .side = Side::motion,
    .domain = Domain::order,
    .parameters = parameters,
    .change_motion = change_motion,
};

}  // namespace ripplenotch
