// SPDX-License-Identifier: MIT
#include <algorithm>
#include <numbers>
#include <vector>

#include "model/effects.hpp"
#include "model/motion/motion.hpp"
#include "model/spring/mass_on_spring.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

// Places at which a screening of a log begins.
constexpr double tried_frequencies[] = {8.0,  11.0, 15.0, 19.0, 23.0, 27.0, 31.0,  36.0,  41.0,
                                        47.0, 53.0, 60.0, 68.0, 77.0, 90.0, 110.0, 150.0, 220.0};
constexpr double tried_dampings[] = {0.06, 0.2, 0.6};  // chosen, not derived: weak, middling, strong
// What the resonance acts on: a log does not show whether its angle is the motor's.
constexpr double ripple_or_whole[] = {0.0, 1.0};

constexpr Parameter parameters[] = {
    {.name = "frequency_hz",
     .unit = "Hz",
     .help = "of the undamped resonance; at the upper bound there is none",
     .neutral = 1e5,
     .start = 40.0,
     .lower = 0.5,
     .upper = 1e5,
     .logarithmic = true,
     .tried = tried_frequencies},
    {.name = "damping",
     .unit = "",
     .help = "damping ratio; from 0.5 on it is a low-pass of second order rather than a resonance",
     .neutral = 0.1,
     .start = 0.1,
     .lower = 0.001,
     .upper = 2.0,
     .logarithmic = true,
     .tried = tried_dampings},
    {.name = "direct",
     .unit = "",
     .help =
         "ripple that does not pass the elastic joint, as a part of what does; 1 at 180 deg is what an error "
         "of the gear's angle makes",
     .upper = 1000.0,
     .left_out = LeftOut::assumed},
    {.name = "direct_phase_deg",
     .unit = "deg",
     .help = "by which it is ahead of what passes, at standstill",
     .lower = -360.0,
     .upper = 360.0,
     .left_out = LeftOut::assumed},
    {.name = "order",
     .unit = "",
     .help = "of the ripple that it changes, in cycles per motor revolution; 0 is every order",
     .upper = 1000.0,
     .left_out = LeftOut::assumed},
    {.name = "whole",
     .unit = "",
     .help = "1 where the motor's angle is logged, so that inertia, friction and all other torque pass the "
             "elastic "
             "joint as well; 0: the ripple alone",
     .upper = 1.0,
     .left_out = LeftOut::assumed,
     .tried = ripple_or_whole},
};

constexpr LookAlike look_alikes[] = {
    {"ripple-speed-dependence", "its frequency is above the fastest ripple",
     "a faster move: a resonance turns the phase as well"},
    {"lag", "the damping is 0.5 or more", "inertia torque and ripple in the same log: a lag delays both"},
    {"delay", "its frequency is above the fastest ripple", "a faster move"},
};

void change_ripple(const Situation& situation, Order order, std::span<const double> values,
                   std::span<std::complex<double>> gain) {
    if (values[0] >= parameters[0].upper || values[5] >= 0.5 || !concerns(order, values[4])) return;
    std::vector<std::complex<double>> passing(gain.size());
    response_of({values[0], values[1]}, situation.motion, order.value() * situation.ratio.value() / 360.0,
                passing);
    const auto direct = portable::polar(values[2], values[3] / degrees_per_radian);
    for (std::size_t k = 0; k < gain.size(); ++k) {
        const double a = gain[k].real(), b = gain[k].imag();
        const double x = passing[k].real() + direct.real(), y = passing[k].imag() + direct.imag();
        gain[k].real(a * x - b * y);
        gain[k].imag(a * y + b * x);
    }
}

// The joint's torques depend on the angle of the link, which leads the motor's by the spring's twist under
// its inertia. The acceleration stays the motor's: inertia passes the spring with all else.
void change_motion(std::span<const double> values, Motion& motion, GearRatio&) {
    if (values[0] >= parameters[0].upper || values[5] < 0.5 || motion.size() < 2) return;
    const double radians_per_s = 2.0 * std::numbers::pi * values[0];
    std::vector<double> ahead_deg = motion.acceleration_deg_s2;
    for (double& ahead : ahead_deg) ahead /= -radians_per_s * radians_per_s;
    on_whole_clock(motion.time_s, motion.sample_rate.value(), ahead_deg,
                   [&](std::span<double> whole, double rate_hz) {
                       pass_spring({values[0], values[1]}, Hertz(rate_hz), whole);
                   });
    const std::size_t last = motion.size() - 1;
    for (std::size_t k = 0; k <= last; ++k) {
        const std::size_t before = k - std::min<std::size_t>(k, 1), after = std::min(k + 1, last);
        motion.position_deg[k] += ahead_deg[k];
        motion.velocity_deg_s[k] +=
            (ahead_deg[after] - ahead_deg[before]) / (motion.time_s[after] - motion.time_s[before]);
    }
}

void apply(const Situation& situation, std::span<const double> values, std::span<double> torque_nm) {
    if (values[0] >= parameters[0].upper || values[5] < 0.5) return;
    on_whole_clock(situation.motion.time_s, situation.motion.sample_rate.value(), torque_nm,
                   [&](std::span<double> whole, double rate_hz) {
                       pass_spring({values[0], values[1]}, Hertz(rate_hz), whole);
                   });
}

}  // namespace

const Effect effects::resonance{
    .name = "resonance",
    .summary = "the joint's elasticity swells the ripple where the frequency of a line meets it",
    .equation =
        "ripple * (H + direct * e^(i direct_phase_deg)), H = 1 / (1 - u^2 + 2 i damping u) and "
        "what still rings, u = order * gear_ratio * v / 360 / frequency_hz",
    .symptom =
        "lines of the ripple in the residual in a band of speed, with a phase that turns by half a cycle "
        "through it",
    .look_alikes = look_alikes,
    .source = "a mass on a damped spring; Tuttle, 1992",
    .side = Side::ripple,
    .domain = Domain::frequency,
    .parameters = parameters,
    .whole = 5,
    .apply = apply,
    .change_motion = change_motion,
    .change_ripple = change_ripple,
};

}  // namespace ripplenotch
