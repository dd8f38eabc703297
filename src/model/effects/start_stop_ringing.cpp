// SPDX-License-Identifier: MIT
#include <algorithm>

#include "model/catalogue.hpp"
#include "model/effects.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

// Places at which a screening of a log begins.
constexpr double tried_frequencies[] = {1.5, 2.0, 2.7, 3.6, 4.7, 6.2, 8.0, 10.5, 14.0, 18.0, 24.0};
constexpr double tried_decays[] = {0.08, 0.25};  // chosen, not derived

constexpr Parameter parameters[] = {
    {.name = "amplitude_nm",
     .unit = "Nm",
     .help = "zero to peak just after a start; a stop has the opposite sign",
     .start = 0.5,
     .upper = 1e5,
     .linear = true},
    {.name = "phase_deg",
     .unit = "deg",
     .help = "of the cosine at the start or stop",
     .lower = -360.0,
     .upper = 360.0},
    {.name = "frequency_hz",
     .unit = "Hz",
     .help = "of the ringing",
     .neutral = 5.0,
     .start = 5.0,
     .lower = 0.05,
     .upper = 1e4,
     .logarithmic = true,
     .tried = tried_frequencies},
    {.name = "decay_s",
     .unit = "s",
     .help = "time in which it falls to 37 %",
     .neutral = 0.2,
     .start = 0.2,
     .lower = 0.001,
     .upper = 100.0,
     .logarithmic = true,
     .tried = tried_decays},
};

constexpr LookAlike look_alikes[] = {
    {"stribeck-friction", "every slow sample belongs to a start or a stop", "a long pass at low speed"},
    {"inertia", "the acceleration was smoothed more than the start lasts",
     "a shorter smoothing, or a slower start"},
    {"tone", "it decays slowly and the log has few starts", "a rest as long as several decays"},
};

void apply(const Situation& situation, std::span<const double> values, std::span<double> torque_nm) {
    const Motion& motion = situation.motion;
    const double step_s = 1.0 / motion.sample_rate.value();
    const double turn_deg = 360.0 * values[2] * step_s;
    const double shrink = portable::exp(-std::min(step_s / values[3], 700.0));
    const double turn_real = shrink * portable::cos_degrees(turn_deg),
                 turn_imaginary = shrink * portable::sin_degrees(turn_deg);
    const double cosine = portable::cos_degrees(values[1]), sine = portable::sin_degrees(values[1]);
    double real = 0.0, imaginary = 0.0;
    Movement movement;
    for (std::size_t k = 0; k < torque_nm.size(); ++k) {
        const double turned = real * turn_real - imaginary * turn_imaginary;
        imaginary = real * turn_imaginary + imaginary * turn_real;
        real = turned + movement.kick(motion.velocity_deg_s[k]);
        torque_nm[k] += values[0] * (real * cosine - imaginary * sine);
    }
}

}  // namespace

const Effect effects::start_stop_ringing{
    .name = "start-stop-ringing",
    .summary = "the joint rings when it starts and stops",
    .equation =
        "torque = sum over starts (+) and stops (-) of direction * amplitude_nm * exp(-s / decay_s) * "
        "cos(360 deg * frequency_hz * s + phase_deg), s = time since",
    .symptom =
        "a residual that swings and decays after each start and stop, the other way round in the other "
        "direction",
    .look_alikes = look_alikes,
    .source =
        "the answer of a lightly damped mass to a step; both ends of the move in Kim, Kim, Song, Trans. KSME "
        "A, 2011, fig. 11",
    .side = Side::joint,
    .domain = Domain::time,
    .parameters = parameters,
    .polar = Polar{0, 1},
    .apply = apply,
};

}  // namespace ripplenotch
