// SPDX-License-Identifier: MIT
#include <vector>

#include "core/functions/many_numbers.hpp"
#include "model/effects.hpp"
#include "model/evaluate.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr Parameter parameters[] = {
    {.name = "inertia_kgm2",
     .unit = "kgm2",
     .help = "by which the inertia about the joint axis grows",
     .lower = -1e5,
     .upper = 1e5,
     .linear = true},
    {.name = "cosine_nm",
     .unit = "Nm",
     .help = "by which the gravity torque grows where the joint's position is zero",
     .start = 0.5,
     .lower = -1e5,
     .upper = 1e5,
     .linear = true},
    {.name = "sine_nm",
     .unit = "Nm",
     .help = "by which the gravity torque grows a quarter turn on",
     .lower = -1e5,
     .upper = 1e5,
     .linear = true},
    {.name = "time_s",
     .unit = "s",
     .help = "of the change, from the first sample of the log",
     .neutral = 1.0,
     .start = 1.0,
     .upper = 1e6,
     .hint = Hint::change_times},
    {.name = "ramp_s",
     .unit = "s",
     .help = "time after the middle of the change in which 76 % of its second half is made",
     .neutral = 0.05,
     .start = 0.05,
     .lower = 0.001,
     .upper = 100.0,
     .logarithmic = true,
     .left_out = LeftOut::assumed},
};

constexpr LookAlike look_alikes[] = {
    {"gravity", "the change is near the beginning of the log", "a log that begins well before the change"},
    {"drift", "the joint hardly moves after the change",
     "moves over half a turn before and after the change"},
    {"offset", "the joint rests after the change", "moves over half a turn before and after the change"},
    {"an impact or a contact of the arm", "the log ends soon after the change",
     "moves over half a turn after the change: a payload stays"},
};

void apply(const Situation& situation, std::span<const double> values, std::span<double> torque_nm) {
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
}

}  // namespace

const Effect effects::payload_change{
    .name = "payload-change",
    .summary = "a mass is picked up or put down: inertia and gravity change at a time",
    .equation =
        "torque = (1 + tanh((t - time_s) / ramp_s)) / 2 * (inertia_kgm2 * dv/dt in rad/s2 + cosine_nm * "
        "cos(q) + sine_nm * sin(q))",
    .symptom = "a residual that follows acceleration and position from a time on, and is absent before it",
    .look_alikes = look_alikes,
    .source = "statics and Newton's second law; Atkeson, An, Hollerbach, IJRR 5, 1986, for payloads",
    .side = Side::joint,
    .domain = Domain::time,
    .parameters = parameters,
    .bears_load = true,
    .apply = apply,
};

}  // namespace ripplenotch
