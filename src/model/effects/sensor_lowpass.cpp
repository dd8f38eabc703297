// SPDX-License-Identifier: MIT
#include <numbers>

#include "model/effects.hpp"
#include "model/motion/motion.hpp"
#include "model/spring/mass_on_spring.hpp"

namespace ripplenotch {
namespace {

// From here on nothing is filtered.
constexpr double no_filter_hz = 1e5;
// Places at which a screening of a log begins.
constexpr double tried_cutoffs[] = {6.0, 9.0, 13.0, 19.0, 28.0, 42.0, 63.0, 95.0, 140.0};

constexpr Parameter parameters[] = {
    {.name = "cutoff_hz",
     .unit = "Hz",
     .help = "frequency at which 71 % of the amplitude remains; the highest is no filter",
     .neutral = no_filter_hz,
     .start = 50.0,
     .lower = 0.1,
     .upper = no_filter_hz,
     .logarithmic = true,
     .tried = tried_cutoffs},
};

constexpr LookAlike look_alikes[] = {
    {"lag", "the ripple is slow against the cut-off frequency, or fast against it throughout",
     "a move whose ripple passes the cut-off frequency: second order falls twice as steeply and turns the "
     "phase twice as far"},
    {"delay", "the ripple is slow against the cut-off frequency",
     "a faster move: a low-pass makes the ripple smaller, a delay does not"},
    {"resonance", "the damping is 0.5 or more", "a faster move"},
    {"ripple-speed-dependence", "the ripple falls with the speed",
     "inertia torque and ripple in the same log: a low-pass delays both"},
};

void apply(const Situation& situation, std::span<const double> values, std::span<double> torque_nm) {
    if (values[0] >= no_filter_hz) return;
    const Spring second_order{.frequency_hz = values[0], .damping = 0.5 * std::numbers::sqrt2};
    on_whole_clock(
        situation.motion.time_s, situation.motion.sample_rate.value(), torque_nm,
        [&](std::span<double> whole, double rate_hz) { pass_spring(second_order, Hertz(rate_hz), whole); });
}

}  // namespace

const Effect effects::sensor_lowpass{
    .name = "sensor-lowpass",
    .summary = "the torque passes a Butterworth low-pass of second order",
    .equation = "y'' + sqrt(2) w y' + w^2 y = w^2 * torque, w = 2 pi cutoff_hz, y the logged torque",
    .symptom = "the residual of a delay, and ripple that beyond a speed falls with its square",
    .look_alikes = look_alikes,
    .source = "Butterworth, Experimental Wireless and the Wireless Engineer 7, 1930",
    .side = Side::sensor,
    .domain = Domain::frequency,
    .parameters = parameters,
    .apply = apply,
};

}  // namespace ripplenotch
