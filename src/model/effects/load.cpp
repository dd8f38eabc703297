// SPDX-License-Identifier: MIT
#include <vector>

#include "core/functions/many_numbers.hpp"
#include "core/vectors/dot.hpp"
#include "model/effects.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

const Effect effects::inertia{
    .name = "inertia",
    .summary = "torque that accelerates the link",
    .equation = "torque = inertia_kgm2 * acceleration * pi / 180",
    .symptom = "a residual in proportion to the acceleration, zero at rest and at constant speed",
    .look_alikes = {{"a wrong gain of the torque sensor", "always, unless ripple or gravity are known in Nm",
                     "a known weight at rest"},
                    {"load-friction", "the joint moves one way only", "a log that reverses"}},
    .source = "Newton; Kim, Kim, Song, Trans. KSME A, 2011, eq. 4",
    .domain = Domain::speed,
    .parameters = {linear("inertia_kgm2", "kgm2",
                          "moment of inertia of everything behind the sensor, about the joint axis",
                          {1.0, 0.0, 1e5})},
    .bears_load = true,
    .apply = [](const Situation& situation, Values values, Torques torque_nm) {
        const double nm_per_deg_s2 = values[0] / degrees_per_radian;
        for (std::size_t k = 0; k < torque_nm.size(); ++k)
            torque_nm[k] += nm_per_deg_s2 * situation.motion.acceleration_deg_s2[k];
    }};

const Effect effects::gravity{
    .name = "gravity",
    .summary = "weight of the link about a joint axis that is not vertical",
    .equation = "torque = amplitude_nm * cos(q + phase_deg)",
    .symptom =
        "the same torque at the same position in both directions, at rest too; one cycle per output "
        "revolution",
    .look_alikes = {{"crosstalk of the sensor, once per output revolution", "always",
                     "a second mounting of the joint; no log of one mounting distinguishes them"},
                    {"offset", "the travel is below 30 deg", "a travel of half a turn"},
                    {"quadratic-viscous-friction", "the log is one smooth stroke",
                     "the same positions passed at two speeds, or in both directions"},
                    {"drift", "the log is one stroke", "coming back to the same position later"}},
    .source = "statics; Taghirad and Belanger, 1998, for the crosstalk",
    .domain = Domain::position,
    .parameters =
        {linear("amplitude_nm", "Nm",
                "mass * 9.81 m/s2 * distance of the centre of mass from the axis * cosine of the axis' tilt",
                {1.0, 0.0, 1e5}),
         plain("phase_deg", "deg",
               "angle of the centre of mass above the horizontal where the joint's position is zero",
               {0.0, -360.0, 360.0})},
    .polar = Polar{0, 1},
    .bears_load = true,
    .apply = [](const Situation& situation, Values values, Torques torque_nm) {
        const auto& position_deg = situation.motion.position_deg;
        with_cosines(
            torque_nm.size(), [&](std::size_t k) { return position_deg[k] + values[1]; },
            [&](std::size_t k, double cosine) { torque_nm[k] += values[0] * cosine; });
    }};

const Effect effects::payload_change{
    .name = "payload-change",
    .summary = "a mass is picked up or put down: inertia and gravity change at a time",
    .equation =
        "torque = (1 + tanh((t - time_s) / ramp_s)) / 2 * (inertia_kgm2 * acceleration * pi / 180 + "
        "cosine_nm * "
        "cos(q) + sine_nm * sin(q))",
    .symptom = "a residual that follows acceleration and position from a time on, and is absent before it",
    .look_alikes = {{"gravity", "the change is near the beginning of the log",
                     "a log that begins well before the change"},
                    {"drift", "the joint hardly moves after the change",
                     "moves over half a turn before and after the change"},
                    {"offset", "the joint rests after the change",
                     "moves over half a turn before and after the change"},
                    {"an impact or a contact of the arm", "the log ends soon after the change",
                     "moves over half a turn after the change: a payload stays"}},
    .source = "statics and Newton's second law; Atkeson, An, Hollerbach, IJRR 5, 1986, for payloads",
    .domain = Domain::time,
    .parameters =
        {linear("inertia_kgm2", "kgm2", "by which the inertia about the joint axis grows", {0.0, -1e5, 1e5}),
         linear("cosine_nm", "Nm", "by which the gravity torque grows where the joint's position is zero",
                {0.5, -1e5, 1e5}),
         linear("sine_nm", "Nm", "by which the gravity torque grows a quarter turn on", {0.0, -1e5, 1e5}),
         plain("time_s", "s", "of the change, from the first sample of the log", {1.0, 0.0, 1e6, 1.0}),
         assumed(logarithmic("ramp_s", "s",
                             "time after the middle of the change in which 76 % of its second half is made",
                             {0.05, 0.001, 100.0, 0.05}))},
    .bears_load = true,
    .apply = [](const Situation& situation, Values values, Torques torque_nm) {
        const Motion& motion = situation.motion;
        const auto late = [&](std::size_t k) {
            return (motion.time_s[k] - motion.time_s.front() - values[3]) / values[4];
        };
        std::vector<double> step(torque_nm.size());
        with_values(step.size(), late, portable::many_tanh,
                    [&](std::size_t k, double change) { step[k] = 0.5 * (1.0 + change); });
        with_cosines_and_sines(
            torque_nm.size(), [&](std::size_t k) { return motion.position_deg[k]; },
            [&](std::size_t k, double cosine, double sine) {
                torque_nm[k] += step[k] * (values[0] * motion.acceleration_deg_s2[k] / degrees_per_radian +
                                           values[1] * cosine + values[2] * sine);
            });
    }};

const Effect effects::simulation_scale{
    .name = "simulation-scale",
    .summary = "the measured torque is a multiple of the simulated one: torque constant, gear ratio or unit",
    .equation = "torque = error_percent / 100 * simulated torque",
    .symptom = "a residual in proportion to the simulated torque",
    .look_alikes = {{"inertia", "the simulated torque is mostly that of the inertia",
                     "a log in which the joint holds a weight, or the same motion with another load"},
                    {"gravity", "the joint moves slowly", "faster moves"},
                    {"coulomb-friction", "the simulated torque is mostly friction",
                     "faster moves, or another load"}},
    .source = "the definition of a torque constant",
    .domain = Domain::time,
    .parameters = {linear("error_percent", "%",
                          "by which the measured torque is larger than the simulated one", {1.0, -1e4, 1e6})},
    .bears_load = true,
    .apply = [](const Situation& situation, Values values, Torques torque_nm) {
        const auto& known_nm = situation.motion.known_nm;
        if (!known_nm.empty())
            add_scaled(0.01 * values[0], known_nm.data(), torque_nm.data(), torque_nm.size());
    }};

}  // namespace ripplenotch
