// SPDX-License-Identifier: MIT
#include "model/effects.hpp"

namespace ripplenotch {
namespace {

// Places at which a screening of a log begins.
constexpr double tried_biases[] = {-0.5, -0.3, -0.2, -0.12, -0.06, -0.03, -0.01,
                                   0.01, 0.03, 0.06, 0.12,  0.2,   0.3,   0.5};

constexpr Parameter parameters[] = {
    {.name = "bias_deg_s",
     .unit = "deg/s",
     .help = "that the log shows too much",
     .start = 0.01,
     .lower = -100.0,
     .upper = 100.0,
     .tried = tried_biases},
};

constexpr LookAlike look_alikes[] = {
    {"gear-ratio", "the log is one stroke",
     "strokes both ways: the phase error of a ratio returns, that of a bias grows on"},
    {"delay", "the log is one stroke", "strokes both ways"},
};

void change_motion(std::span<const double> values, Motion& motion, GearRatio&) {
    const double bias_deg_s = values[0];
    if (bias_deg_s == 0.0) return;
    const double start_s = motion.time_s.empty() ? 0.0 : motion.time_s.front();
    for (std::size_t k = 0; k < motion.size(); ++k) {
        motion.velocity_deg_s[k] -= bias_deg_s;
        motion.position_deg[k] -= bias_deg_s * (motion.time_s[k] - start_s);
    }
}

}  // namespace

const Effect effects::velocity_bias{
    .name = "velocity-bias",
    .summary =
        "the velocity of the log has a constant error, and the position integrated from it an error that "
        "grows with time",
    .equation = "v - bias_deg_s replaces v, q - bias_deg_s * t replaces q",
    .symptom = "lines of the ripple in the residual whose phase error grows with time while the joint moves",
    .look_alikes = look_alikes,
    .source = "integration of an offset",
    .side = Side::motion,
    .domain = Domain::order,
    .parameters = parameters,
    .change_motion = change_motion,
};

}  // namespace ripplenotch
