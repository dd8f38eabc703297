// SPDX-License-Identifier: MIT
#include "model/effects.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

const Effect effects::gear_ratio{
    .name = "gear-ratio",
    .summary = "the gear ratio differs from that of the model",
    .equation = "gear_ratio * (1 + error_percent / 100) replaces gear_ratio",
    .symptom =
        "lines of the ripple in the residual whose phase error grows with the angle gone; with quite another "
        "ratio, lines at orders that the model does not have",
    .look_alikes = {{"velocity-bias", "the log is one stroke",
                     "strokes both ways: the phase error of a ratio returns, that of a bias grows on"},
                    {"ripple-modulation", "the joint turns less than a revolution",
                     "a travel of a whole output revolution"},
                    {"a wrong scale of the position or velocity", "always, unless the travel is known",
                     "the travel of a known move"}},
    .source = "the definition of the ratio",
    .side = Side::motion,
    .domain = Domain::order,
    .parameters = {plain("error_percent", "%", "by which the gear ratio is larger than in the model",
                         {0.1, -99.0, 900.0})},
    .change_motion = [](Values values, Motion&, GearRatio& ratio) {
        ratio = GearRatio(ratio.value() * (1.0 + 0.01 * values[0]));
    }};

const Effect effects::velocity_bias{
    .name = "velocity-bias",
    .summary =
        "the velocity of the log has a constant error, and the position integrated from it an error that "
        "grows with time",
    .equation = "v - bias_deg_s replaces v, q - bias_deg_s * t replaces q",
    .symptom = "lines of the ripple in the residual whose phase error grows with time while the joint moves",
    .look_alikes = {{"gear-ratio", "the log is one stroke",
                     "strokes both ways: the phase error of a ratio returns, that of a bias grows on"},
                    {"delay", "the log is one stroke", "strokes both ways"}},
    .source = "integration of an offset",
    .side = Side::motion,
    .domain = Domain::order,
    .parameters = {plain("bias_deg_s", "deg/s", "that the log shows too much", {0.01, -100.0, 100.0})},
    .change_motion = [](Values values, Motion& motion, GearRatio&) {
        const double bias_deg_s = values[0];
        if (bias_deg_s == 0.0) return;
        const double start_s = motion.time_s.empty() ? 0.0 : motion.time_s.front();
        for (std::size_t k = 0; k < motion.size(); ++k) {
            motion.velocity_deg_s[k] -= bias_deg_s;
            motion.position_deg[k] -= bias_deg_s * (motion.time_s[k] - start_s);
        }
    }};

const Effect effects::encoder_eccentricity{
    .name = "encoder-eccentricity",
    .summary = "the angle of the log errs with the output angle: an eccentric or tilted encoder disc",
    .equation =
        "q - amplitude_deg * cos(order * q + phase_deg) replaces q, and its derivatives those of v and dv/dt",
    .symptom = "lines of the ripple in the residual whose phase error comes and goes with the output angle",
    .look_alikes =
        {{"ripple-modulation", "the log passes few cycles of the error",
          "a travel of two output revolutions: an error of the angle shifts the phase of the ripple, a "
          "modulation its amplitude"},
         {"gear-ratio", "the travel is a small part of a cycle", "a travel of a whole output revolution"},
         {"velocity-bias", "the joint turns at one speed in one direction",
          "strokes in both directions: the phase error of an encoder returns, that of a bias grows on"},
         {"a kinematic error of the gear, once or twice per output revolution", "always",
          "a second encoder on the output"}},
    .source =
        "Ellin and Dolsak, Sensor Review 28, 2008, for eccentric discs; the derivatives by the chain rule",
    .side = Side::motion,
    .domain = Domain::order,
    .parameters = {cycles_parameter("order", "cycles of the error per output revolution", 1.0, 1e3),
                   plain("amplitude_deg", "deg", "error of the angle on the output side, zero to peak",
                         {0.1, 0.0, 10.0}),
                   plain("phase_deg", "deg", "phase of the cosine where the position of the log is zero",
                         {0.0, -360.0, 360.0})},
    .change_motion = [](Values values, Motion& motion, GearRatio&) {
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
    }};

}  // namespace ripplenotch
