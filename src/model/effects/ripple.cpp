// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/functions/many_numbers.hpp"
#include "model/effects.hpp"
#include "model/motion/local_motion.hpp"
#include "model/spring/mass_on_spring.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t from_place = 3;  // of from_deg_s among the parameters of ripple-speed-dependence
constexpr double no_resonance_hz = 1e5;
constexpr double slowest_from_deg_s = 0.001;  // chosen, not derived: slower is standstill

bool is_from_rest(double from_deg_s) { return from_deg_s < slowest_from_deg_s; }

// 1 + gain * growth, or in its other form 1 + gain * (growth - 1).
struct Line {
    double at_rest, growth, unit_deg_s;
};

Line line_of(std::span<const double> values) {
    const double growth = 0.01 * values[0], from_deg_s = values[from_place];
    if (is_from_rest(from_deg_s)) return {1.0, growth, 100.0};
    return {1.0 - growth, growth, from_deg_s};
}

}  // namespace

const Effect effects::ripple{
    .name = "ripple",
    .summary = "torque ripple of the harmonic drive, locked to the motor angle",
    .equation = "torque = amplitude_nm * cos(order * gear_ratio * q + phase_deg)",
    .symptom = "a line at f = order * gear_ratio * |v| / 360 that moves in proportion to the speed",
    .look_alikes = {{"tone", "the log has one speed only",
                     "a second speed: an order moves with it, a tone stays"},
                    {"ripple-modulation", "the joint turns less than half a revolution",
                     "a travel of a whole output revolution"},
                    {"gear-ratio", "the joint turns less than half a revolution",
                     "a travel of a whole output revolution"}},
    .source = "Kim, Kim, Song, Trans. KSME A, 2011, eq. 1 and 3; Taghirad and Belanger, 1998",
    .domain = Domain::order,
    .parameters = {cycles_parameter("order", "cycles per motor revolution", 1.0, 1000.0),
                   cosine_amplitude_parameter(), cosine_phase_parameter()},
    .polar = Polar{1, 2},
    .ripple_order = 0,
    .apply = [](const Situation& situation, Values values, Torques torque_nm) {
        const double cycles_per_turn = values[0] * situation.ratio.value();
        const double amplitude_nm = values[1], phase_deg = values[2];
        const auto& position_deg = situation.motion.position_deg;
        const auto angle_deg = [&](std::size_t k) { return cycles_per_turn * position_deg[k] + phase_deg; };
        const auto gain = situation.ripple_gain;
        if (gain.empty()) {
            with_cosines(torque_nm.size(), angle_deg,
                         [&](std::size_t k, double cosine) { torque_nm[k] += amplitude_nm * cosine; });
            return;
        }
        with_cosines_and_sines(torque_nm.size(), angle_deg, [&](std::size_t k, double cosine, double sine) {
            torque_nm[k] += amplitude_nm * (gain[k].real() * cosine - gain[k].imag() * sine);
        });
    }};

const Effect effects::output_ripple{
    .name = "output-ripple",
    .summary =
        "torque that repeats with the output angle: misalignment, crosstalk of the sensor, a bearing behind "
        "the gear",
    .equation = "torque = amplitude_nm * cos(order * q + phase_deg)",
    .symptom = "the same torque at the same position in both directions, order cycles per output revolution",
    .look_alikes = {{"gravity", "the order is 2 and the travel is below half a turn",
                     "a travel of a whole output revolution"},
                    {"ripple", "the order is near a multiple of the gear ratio",
                     "a travel of several output revolutions"},
                    {"offset", "the travel is a small part of a cycle",
                     "a travel of a whole output revolution"}},
    .source =
        "Taghirad and Belanger, 1998, for misalignment; Godler et al., 1999, for the placing of the gauges",
    .domain = Domain::position,
    .parameters = {cycles_parameter("order", "cycles per output revolution", 2.0, 1e5),
                   cosine_amplitude_parameter(), cosine_phase_parameter()},
    .polar = Polar{1, 2},
    .apply = [](const Situation& situation, Values values, Torques torque_nm) {
        const auto& position_deg = situation.motion.position_deg;
        with_cosines(
            torque_nm.size(), [&](std::size_t k) { return values[0] * position_deg[k] + values[2]; },
            [&](std::size_t k, double cosine) { torque_nm[k] += values[1] * cosine; });
    }};

const Effect effects::ripple_speed_dependence{
    .name = "ripple-speed-dependence",
    .summary = "ripple whose size changes with the speed",
    .equation =
        "ripple amplitude * (1 + gain_percent / 100 * (|v| / 100 deg/s)^exponent); with from_deg_s: ripple "
        "amplitude * (1 + gain_percent / 100 * ((|v| / from_deg_s)^exponent - 1))",
    .symptom = "lines of the ripple in the residual that grow, or change sign, with the speed",
    .look_alikes = {{"resonance", "its frequency is above the fastest ripple",
                     "a faster move: a resonance turns the phase as well"},
                    {"lag", "the ripple falls with the speed",
                     "inertia torque and ripple in the same log: a lag delays both"},
                    {"ripple-load-dependence", "the log is one smooth stroke",
                     "the same speed with and without acceleration"}},
    .source =
        "measured harmonic drives, whose ripple changes up to eightfold over the speed range; Taghirad and "
        "Belanger, 1998",
    .side = Side::ripple,
    .domain = Domain::order,
    .parameters = {linear("gain_percent", "%",
                          "by which the ripple is larger at 100 deg/s than at rest; with from_deg_s: which "
                          "part of the ripple at that speed is gone at rest",
                          {30.0, -1000.0, 1e6}),
                   plain("exponent", "", "how it grows with the speed; 1 is in proportion",
                         {1.0, 0.1, 4.0, 1.0}),
                   ripple_order_parameter(),
                   assumed(
                       plain("from_deg_s", "deg/s",
                             "speed at which the ripple has the amplitude of its term; below 0.001 at rest",
                             {0.0, 0.0, 1e5}))},
    .change_ripple = [](const Situation& situation, Order order, Values values, Gains gain) {
        if (!concerns(order, values[2])) return;
        const Line line = line_of(values);
        const auto speed = [&](std::size_t k) {
            return std::abs(situation.motion.velocity_deg_s[k]) / line.unit_deg_s;
        };
        const auto raise = [&](std::span<double> speeds) { portable::pow(speeds, values[1], speeds); };
        with_values(gain.size(), speed, raise,
                    [&](std::size_t k, double grown) { gain[k] *= line.at_rest + line.growth * grown; });
    }};

const Effect effects::ripple_load_dependence{
    .name = "ripple-load-dependence",
    .summary = "ripple whose size grows with the torque that the gear carries",
    .equation =
        "ripple amplitude * (1 + gain_percent_per_nm / 100 * |load| / 1 Nm), load = torque of inertia and "
        "gravity",
    .symptom = "lines of the ripple in the residual where the joint accelerates or holds a weight",
    .look_alikes = {{"ripple-speed-dependence", "the log is one smooth stroke",
                     "the same speed with and without acceleration"},
                    {"load-friction", "the ripple is faster than the sample rate shows", "a slower move"}},
    .source = "Taghirad and Belanger, 1998; Kim, Kim, Song, Trans. KSME A, 2011, who leave it out",
    .side = Side::ripple,
    .domain = Domain::order,
    .parameters = {linear("gain_percent_per_nm", "%/Nm",
                          "by which the ripple grows with each newton-metre of load", {5.0, -1000.0, 1e4}),
                   ripple_order_parameter()},
    .uses_load = true,
    .change_ripple = [](const Situation& situation, Order order, Values values, Gains gain) {
        if (!concerns(order, values[1])) return;
        for (std::size_t k = 0; k < gain.size(); ++k)
            gain[k] *= 1.0 + 0.01 * values[0] * std::abs(situation.load_nm[k]);
    }};

const Effect effects::ripple_direction_dependence{
    .name = "ripple-direction-dependence",
    .summary = "ripple that differs with the direction, because other flanks of the teeth carry",
    .equation =
        "ripple amplitude * (1 + gain_percent / 100 * d), ripple phase + phase_deg * d, d = tanh(v / "
        "width_deg_s)",
    .symptom = "lines of the ripple in the residual of opposite sign in the two directions",
    .look_alikes = {{"delay", "there is one speed in each direction",
                     "two speeds in the same direction: the phase of a delay grows with the speed"},
                    {"gear-ratio", "the log is one stroke each way", "several strokes"}},
    .source = "change of flank in gearing; measured harmonic drives",
    .side = Side::ripple,
    .domain = Domain::order,
    .parameters =
        {linear(
             "gain_percent", "%",
             "by which the ripple is larger in positive direction, and smaller in negative, than their mean",
             {20.0, -1000.0, 1000.0}),
         plain("phase_deg", "deg",
               "by which the ripple is ahead in positive direction, and behind in negative",
               {0.0, -90.0, 90.0}),
         width_parameter(), ripple_order_parameter()},
    .change_ripple = [](const Situation& situation, Order order, Values values, Gains gain) {
        if (!concerns(order, values[3])) return;
        if (values[0] == 0.0 && values[1] == 0.0) return;
        std::vector<double> direction(gain.size());
        with_directions(situation.motion, values[2],
                        [&](std::size_t k, double step) { direction[k] = step; });
        with_cosines_and_sines(
            gain.size(), [&](std::size_t k) { return values[1] * direction[k]; },
            [&](std::size_t k, double of_turn, double sine_of_turn) {
                const double size = 1.0 + 0.01 * values[0] * direction[k];
                const auto before = gain[k];
                const double cosine = size * of_turn, sine = size * sine_of_turn;
                gain[k] = {before.real() * cosine - before.imag() * sine,
                           before.real() * sine + before.imag() * cosine};
            });
    }};

const Effect effects::ripple_modulation{
    .name = "ripple-modulation",
    .summary =
        "ripple whose size swells and fades with the output angle: an eccentric or tilted circular spline",
    .equation = "ripple amplitude * (1 + depth_percent / 100 * cos(output_order * q + phase_deg))",
    .symptom = "sidebands of each line of the ripple, output_order cycles per output revolution away",
    .look_alikes = {{"gear-ratio", "the joint turns less than a revolution",
                     "a travel of a whole output revolution"},
                    {"ripple-load-dependence", "gravity makes the load follow the position",
                     "the same positions with another load"}},
    .source =
        "amplitude modulation; Tuttle, 1992, and Taghirad and Belanger, 1998, for dissipation and torque "
        "that change over the output turn",
    .side = Side::ripple,
    .domain = Domain::order,
    .parameters = {cycles_parameter("output_order", "cycles of the modulation per output revolution", 1.0,
                                    1e4),
                   linear("depth_percent", "%", "zero to peak, of the size of the ripple",
                          {30.0, 0.0, 1000.0}),
                   cosine_phase_parameter(), ripple_order_parameter()},
    .polar = Polar{1, 2},
    .change_ripple = [](const Situation& situation, Order order, Values values, Gains gain) {
        if (!concerns(order, values[3])) return;
        const auto& position_deg = situation.motion.position_deg;
        with_cosines(
            gain.size(), [&](std::size_t k) { return values[0] * position_deg[k] + values[2]; },
            [&](std::size_t k, double cosine) { gain[k] *= 1.0 + 0.01 * values[1] * cosine; });
    }};

const Effect effects::resonance{
    .name = "resonance",
    .summary = "the joint's elasticity swells the ripple where the frequency of a line meets it",
    .equation =
        "ripple * (H + direct * e^(i direct_phase_deg)), H = 1 / (1 - u^2 + 2 i damping u) and what still "
        "rings, u = order * gear_ratio * v / 360 / frequency_hz",
    .symptom =
        "lines of the ripple in the residual in a band of speed, with a phase that turns by half a cycle "
        "through it",
    .look_alikes = {{"ripple-speed-dependence", "its frequency is above the fastest ripple",
                     "a faster move: a resonance turns the phase as well"},
                    {"lag", "the damping is 0.5 or more",
                     "inertia torque and ripple in the same log: a lag delays both"},
                    {"delay", "its frequency is above the fastest ripple", "a faster move"}},
    .source = "a mass on a damped spring; Tuttle, 1992",
    .side = Side::ripple,
    .domain = Domain::frequency,
    .parameters =
        {logarithmic("frequency_hz", "Hz", "of the undamped resonance; at the upper bound there is none",
                     {40.0, 0.5, no_resonance_hz, no_resonance_hz},
                     {8.0, 11.0, 15.0, 19.0, 23.0, 27.0, 31.0, 36.0, 41.0, 47.0, 53.0, 60.0, 68.0, 77.0, 90.0,
                      110.0, 150.0, 220.0}),
         logarithmic("damping", "",
                     "damping ratio; from 0.5 on it is a low-pass of second order rather than a resonance",
                     {0.1, 0.001, 2.0, 0.1}),  // chosen, not derived: weak, middling, strong

         assumed(plain("direct", "",
                       "ripple that does not pass the elastic joint, as a part of what does; 1 at 180 deg is "
                       "what an error of the gear's angle makes",
                       {0.0, 0.0, 1000.0})),
         assumed(plain("direct_phase_deg", "deg", "by which it is ahead of what passes, at standstill",
                       {0.0, -360.0, 360.0})),
         assumed(plain("order", "",
                       "of the ripple that it changes, in cycles per motor revolution; 0 is every order",
                       {0.0, 0.0, 1000.0})),
         // A log does not show whether its angle is the motor's.
         assumed(plain("whole", "",
                       "1 where the motor's angle is logged, so that inertia, friction and all other torque "
                       "pass the elastic joint as well; 0: the ripple alone",
                       {0.0, 0.0, 1.0}))},
    .whole = 5,
    .apply =
        [](const Situation& situation, Values values, Torques torque_nm) {
            if (values[0] >= no_resonance_hz || values[5] < 0.5) return;
            on_whole_clock(situation.motion.time_s, situation.motion.sample_rate.value(), torque_nm,
                           [&](std::span<double> whole, double rate_hz) {
                               pass_spring({values[0], values[1]}, Hertz(rate_hz), whole);
                           });
        },
    // The joint's torques depend on the angle of the link, which leads the motor's by the spring's twist
    // under its inertia. The acceleration stays the motor's: inertia passes the spring with all else.
    .change_motion =
        [](Values values, Motion& motion, GearRatio&) {
            if (values[0] >= no_resonance_hz || values[5] < 0.5 || motion.size() < 2) return;
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
        },
    .change_ripple =
        [](const Situation& situation, Order order, Values values, Gains gain) {
            if (values[0] >= no_resonance_hz || values[5] >= 0.5 || !concerns(order, values[4])) return;
            std::vector<std::complex<double>> passing(gain.size());
            response_of({values[0], values[1]}, situation.motion,
                        order.value() * situation.ratio.value() / 360.0, passing);
            const auto direct = portable::polar(values[2], values[3] / degrees_per_radian);
            for (std::size_t k = 0; k < gain.size(); ++k) {
                const double a = gain[k].real(), b = gain[k].imag();
                const double x = passing[k].real() + direct.real(), y = passing[k].imag() + direct.imag();
                gain[k].real(a * x - b * y);
                gain[k].imag(a * y + b * x);
            }
        }};

}  // namespace ripplenotch
