// SPDX-License-Identifier: MIT
#include "model/effects.hpp"
#include "model/motion/motion.hpp"
#include "model/spring/mass_on_spring.hpp"

namespace ripplenotch {
namespace {

// Places at which a screening of a log begins.
constexpr double tried_time_constants[] = {0.0005, 0.0015, 0.003, 0.005, 0.008, 0.012, 0.02, 0.04};

constexpr Parameter parameters[] = {
    {.name = "time_constant_s",
     .unit = "s",
     .help = "1 / (2 pi times the cut-off frequency in Hz): 0.00796 for 20 Hz",
     .start = 0.002,
     .upper = 10.0,
     .tried = tried_time_constants},
};

constexpr LookAlike look_alikes[] = {
    {"delay", "the ripple is slow against the lag",
     "a faster move: a lag makes the ripple smaller, a delay does not"},
    {"sensor-lowpass", "the ripple is slow against the lag, or fast against it throughout",
     "a move whose ripple passes the cut-off frequency: first order falls half as steeply"},
    {"ripple-speed-dependence", "the ripple falls with the speed",
     "inertia torque and ripple in the same log: a lag delays both"},
    {"resonance", "the damping is 0.5 or more", "a faster move"},
};

void apply(const Situation& situation, std::span<const double> values, std::span<double> torque_nm) {
    if (values[0] == 0.0) return;
    on_whole_clock(
        situation.motion.time_s, situation.motion.sample_rate.value(), torque_nm,
        [&](std::span<double> whole, double rate_hz) { first_order_lag(whole, values[0] * rate_hz); });
}

}  // namespace

const Effect effects::lag{
    .name = "lag",
    .summary = "the amplifier or a filter of first order follows with one time constant",
    .equation = "time_constant_s * d(logged torque)/dt + logged torque = torque",
    .symptom = "the residual of a delay, and ripple that is smaller the faster the joint turns",
    .look_alikes = look_alikes,
    .source =
        "the low-pass of first order; Kim, Kim, Song, Trans. KSME A, 2011, section 4.2, for one that was "
        "mislabelled",
    .side = Side::sensor,
    .domain = Domain::frequency,
    .parameters = parameters,
    .apply = apply,
};

}  // namespace ripplenotch
