// SPDX-License-Identifier: MIT
#include <algorithm>
#include <numbers>

#include "core/functions/many_numbers.hpp"
#include "model/effects.hpp"
#include "model/motion/local_motion.hpp"
#include "model/spring/mass_on_spring.hpp"

namespace ripplenotch {
namespace {

// From here on nothing is filtered.
constexpr double no_filter_hz = 1e5;

}  // namespace

const Effect effects::offset{
    .name = "offset",
    .summary = "zero error of the torque sensor",
    .equation = "torque = torque_nm",
    .symptom = "a residual of the same size and sign everywhere, at rest too",
    .look_alikes = {{"coulomb-friction", "the joint moves one way only and never rests",
                     "a log that reverses, or rests"},
                    {"gravity", "the travel is small", "a travel of half a turn"},
                    {"drift", "the log is short", "a log several times as long"}},
    .source = "the definition of a strain gauge bridge's zero",
    .domain = Domain::time,
    .parameters = {linear("torque_nm", "Nm", "what the sensor shows when there is no torque",
                          {0.0, -1e5, 1e5})},
    .apply = [](const Situation&, Values values, Torques torque_nm) {
        for (double& torque : torque_nm) torque += values[0];
    }};

const Effect effects::drift{
    .name = "drift",
    .summary = "the zero of the torque sensor wanders with the clock, as it warms up",
    .equation = "torque = rate_nm_s * time_constant_s * (1 - exp(-t / time_constant_s))",
    .symptom = "a residual that follows the time of the log, at rest too, and not the motion",
    .look_alikes = {{"offset", "the log is short",
                     "a log several times as long, or one that begins after a rest"},
                    {"gravity", "the log is one stroke", "coming back to the same position later"},
                    {"viscous-friction", "the speed only grows or only falls",
                     "the same speed early and late in the log"}},
    .source = "the thermal response of a body of one time constant (Newton's law of cooling)",
    .domain = Domain::time,
    .parameters = {linear("rate_nm_s", "Nm/s", "slope at the beginning", {0.01, -1e3, 1e3}),
                   logarithmic(
                       "time_constant_s", "s",
                       "after which the slope has fallen to 37 %; the longest is a straight line in any log",
                       {100.0, 0.1, 1e6, 1e6})},
    .apply = [](const Situation& situation, Values values, Torques torque_nm) {
        const auto& time_s = situation.motion.time_s;
        const auto exponent = [&](std::size_t k) {
            return -std::min((time_s[k] - time_s.front()) / values[1], 700.0);
        };
        with_values(torque_nm.size(), exponent, portable::many_exp, [&](std::size_t k, double left) {
            torque_nm[k] += values[0] * values[1] * (1.0 - left);
        });
    }};

const Effect effects::tone{
    .name = "tone",
    .summary = "an oscillation of fixed frequency: mains, a fan, a servo's clock",
    .equation =
        "torque = amplitude_nm * cos(360 deg * frequency_hz * t + phase_deg), t = time since the log began",
    .symptom = "a line at one frequency whatever the speed, at rest too",
    .look_alikes = {{"ripple", "the log has one speed only", "a second speed, or a rest: a tone stays"},
                    {"start-stop-ringing", "the log has few starts and it decays slowly",
                     "a rest as long as several decays"}},
    .source = "electrical interference; Kim, Kim, Song, Trans. KSME A, 2011, for the noise at rest",
    .domain = Domain::frequency,
    .parameters = {plain("frequency_hz", "Hz",
                         "cycles per second; 50 and 60 Hz and their multiples are mains",
                         {50.0, 0.001, 1e5, 50.0}),
                   linear("amplitude_nm", "Nm", "zero to peak", {0.1, 0.0, 1e5}),
                   plain("phase_deg", "deg", "phase of the cosine where the log begins",
                         {0.0, -360.0, 360.0})},
    .polar = Polar{1, 2},
    .apply = [](const Situation& situation, Values values, Torques torque_nm) {
        const auto& time_s = situation.motion.time_s;
        with_cosines(
            torque_nm.size(),
            [&](std::size_t k) { return 360.0 * values[0] * (time_s[k] - time_s.front()) + values[2]; },
            [&](std::size_t k, double cosine) { torque_nm[k] += values[1] * cosine; });
    }};

const Effect effects::delay{
    .name = "delay",
    .summary = "the torque is logged later than the motion",
    .equation = "logged torque(t) = torque(t - delay_s)",
    .symptom =
        "lines of the ripple in the residual that grow with the speed, and a residual in proportion to the "
        "jerk",
    .look_alikes = {{"lag", "the ripple is slow against the lag",
                     "a faster move: a lag makes the ripple smaller, a delay does not"},
                    {"sensor-lowpass", "the ripple is slow against the cut-off frequency",
                     "a faster move: a low-pass makes the ripple smaller, a delay does not"},
                    {"ripple-direction-dependence", "there is one speed in each direction",
                     "two speeds in the same direction"},
                    {"velocity-bias", "the log is one stroke",
                     "strokes both ways: the phase of a delay returns, that of a bias grows on"},
                    {"a velocity estimated by a filter or a backward difference", "always",
                     "a comparison of position and velocity"}},
    .source =
        "sampling and transport; Lagrange for the interpolation (Laakso et al., IEEE Signal Processing "
        "Magazine 13, 1996)",
    .side = Side::sensor,
    .domain = Domain::order,
    .parameters = {plain("delay_s", "s",
                         "by which the torque is behind the motion; below 0: the motion is behind the torque",
                         {0.002, -0.5, 0.5})},
    .apply = [](const Situation& situation, Values values, Torques torque_nm) {
        if (values[0] == 0.0) return;
        on_whole_clock(
            situation.motion.time_s, situation.motion.sample_rate.value(), torque_nm,
            [&](std::span<double> whole, double rate_hz) { shift_samples(whole, values[0] * rate_hz); });
    }};

const Effect effects::lag{
    .name = "lag",
    .summary = "the amplifier or a filter of first order follows with one time constant",
    .equation = "time_constant_s * d(logged torque)/dt + logged torque = torque",
    .symptom = "the residual of a delay, and ripple that is smaller the faster the joint turns",
    .look_alikes = {{"delay", "the ripple is slow against the lag",
                     "a faster move: a lag makes the ripple smaller, a delay does not"},
                    {"sensor-lowpass", "the ripple is slow against the lag, or fast against it throughout",
                     "a move whose ripple passes the cut-off frequency: first order falls half as steeply"},
                    {"ripple-speed-dependence", "the ripple falls with the speed",
                     "inertia torque and ripple in the same log: a lag delays both"},
                    {"resonance", "the damping is 0.5 or more", "a faster move"}},
    .source =
        "the low-pass of first order; Kim, Kim, Song, Trans. KSME A, 2011, section 4.2, for one that was "
        "mislabelled",
    .side = Side::sensor,
    .domain = Domain::frequency,
    .parameters = {plain("time_constant_s", "s",
                         "1 / (2 pi times the cut-off frequency in Hz): 0.00796 for 20 Hz",
                         {0.002, 0.0, 10.0})},
    .apply = [](const Situation& situation, Values values, Torques torque_nm) {
        if (values[0] == 0.0) return;
        on_whole_clock(
            situation.motion.time_s, situation.motion.sample_rate.value(), torque_nm,
            [&](std::span<double> whole, double rate_hz) { first_order_lag(whole, values[0] * rate_hz); });
    }};

const Effect effects::sensor_lowpass{
    .name = "sensor-lowpass",
    .summary = "the torque passes a Butterworth low-pass of second order",
    .equation = "y'' + sqrt(2) w y' + w^2 y = w^2 * torque, w = 2 pi cutoff_hz, y the logged torque",
    .symptom = "the residual of a delay, and ripple that beyond a speed falls with its square",
    .look_alikes = {{"lag", "the ripple is slow against the cut-off frequency, or fast against it throughout",
                     "a move whose ripple passes the cut-off frequency: second order falls twice as steeply "
                     "and turns the phase twice as far"},
                    {"delay", "the ripple is slow against the cut-off frequency",
                     "a faster move: a low-pass makes the ripple smaller, a delay does not"},
                    {"resonance", "the damping is 0.5 or more", "a faster move"},
                    {"ripple-speed-dependence", "the ripple falls with the speed",
                     "inertia torque and ripple in the same log: a low-pass delays both"}},
    .source = "Butterworth, Experimental Wireless and the Wireless Engineer 7, 1930",
    .side = Side::sensor,
    .domain = Domain::frequency,
    .parameters = {logarithmic(
        "cutoff_hz", "Hz", "frequency at which 71 % of the amplitude remains; the highest is no filter",
        {50.0, 0.1, no_filter_hz, no_filter_hz}, {6.0, 9.0, 13.0, 19.0, 28.0, 42.0, 63.0, 95.0, 140.0})},
    .apply = [](const Situation& situation, Values values, Torques torque_nm) {
        if (values[0] >= no_filter_hz) return;
        const Spring second_order{.frequency_hz = values[0], .damping = 0.5 * std::numbers::sqrt2};
        on_whole_clock(situation.motion.time_s, situation.motion.sample_rate.value(), torque_nm,
                       [&](std::span<double> whole, double rate_hz) {
                           pass_spring(second_order, Hertz(rate_hz), whole);
                       });
    }};

}  // namespace ripplenotch
