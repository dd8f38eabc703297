// SPDX-License-Identifier: MIT
#include "model/effects.hpp"
#include "model/motion/motion.hpp"
#include "model/spring/mass_on_spring.hpp"

namespace ripplenotch {
namespace {

// Places at which a screening of a log begins: closer than an eighth of a cycle of 100 Hz.
constexpr double tried_delays[] = {-0.012,  -0.0108, -0.0096, -0.0084, -0.0072, -0.006, -0.0048, -0.0036,
                                   -0.0024, -0.0012, 0.0012,  0.0024,  0.0036,  0.0048, 0.006,   0.0072,
                                   0.0084,  0.0096,  0.0108,  0.012,   0.0132,  0.0144, 0.0156,  0.018};

constexpr Parameter parameters[] = {
    {.name = "delay_s",
     .unit = "s",
     .help = "by which the torque is behind the motion; below 0: the motion is behind the torque",
     .start = 0.002,
     .lower = -0.5,
     .upper = 0.5,
     .tried = tried_delays,
     .hint = Hint::delay},
};

constexpr LookAlike look_alikes[] = {
    {"lag", "the ripple is slow against the lag",
     "a faster move: a lag makes the ripple smaller, a delay does not"},
    {"sensor-lowpass", "the ripple is slow against the cut-off frequency",
     "a faster move: a low-pass makes the ripple smaller, a delay does not"},
    {"ripple-direction-dependence", "there is one speed in each direction",
     "two speeds in the same direction"},
    {"velocity-bias", "the log is one stroke",
     "strokes both ways: the phase of a delay returns, that of a bias grows on"},
    {"a velocity estimated by a filter or a backward difference", "always",
     "a comparison of position and velocity"},
};

void apply(const Situation& situation, std::span<const double> values, std::span<double> torque_nm) {
    if (values[0] == 0.0) return;
    on_whole_clock(
        situation.motion.time_s, situation.motion.sample_rate.value(), torque_nm,
        [&](std::span<double> whole, double rate_hz) { shift_samples(whole, values[0] * rate_hz); });
}

}  // namespace

const Effect effects::delay{
    .name = "delay",
    .summary = "the torque is logged later than the motion",
    .equation = "logged torque(t) = torque(t - delay_s)",
    .symptom =
        "lines of the ripple in the residual that grow with the speed, and a residual in proportion to the "
        "jerk",
    .look_alikes = look_alikes,
    .source =
        "sampling and transport; Lagrange for the interpolation (Laakso et al., IEEE Signal Processing "
        "Magazine 13, 1996)",
    .side = Side::sensor,
    .domain = Domain::order,
    .parameters = parameters,
    .apply = apply,
};

}  // namespace ripplenotch
