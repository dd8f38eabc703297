// SPDX-License-Identifier: MIT
#include <algorithm>

#include "core/functions/many_numbers.hpp"
#include "model/effects.hpp"

namespace ripplenotch {
namespace {

// Places at which a screening of a log begins.
constexpr double tried_time_constants[] = {2.0, 5.0, 12.0, 30.0, 100.0, 300.0};

constexpr Parameter parameters[] = {
    {.name = "change_nm",
     .unit = "Nm",
     .help = "friction torque when the log begins, beyond that of the warm gear",
     .start = 0.5,
     .lower = -1e5,
     .upper = 1e5,
     .linear = true},
    {.name = "time_constant_s",
     .unit = "s",
     .help = "after which 37 % of the change remains",
     .neutral = 1.0,
     .start = 30.0,
     .lower = 0.5,
     .upper = 1e5,
     .logarithmic = true,
     .tried = tried_time_constants},
    width_parameter,
};

constexpr LookAlike look_alikes[] = {
    {"coulomb-friction", "the log is short against the time constant",
     "a log several times as long as the time constant, from a cold start"},
    {"drift", "the joint moves one way only", "a log that reverses: drift keeps its sign, friction does not"},
    {"viscous-friction", "the speed only grows or only falls", "the same speed early and late in the log"},
};

void apply(const Situation& situation, std::span<const double> values, std::span<double> torque_nm) {
    const Motion& motion = situation.motion;
    const auto exponent = [&](std::size_t k) {
        return -std::min((motion.time_s[k] - motion.time_s.front()) / values[1], 700.0);
    };
    with_two_values(
        torque_nm.size(), [&](std::size_t k) { return motion.velocity_deg_s[k] / values[2]; },
        portable::many_tanh, exponent, portable::many_exp,
        [&](std::size_t k, double step, double left) { torque_nm[k] += values[0] * step * left; });
}

}  // namespace

const Effect effects::friction_warm_up{
    .name = "friction-warm-up",
    .summary = "friction that changes while the gear and its grease warm up",
    .equation = "torque = change_nm * exp(-t / time_constant_s) * tanh(v / width_deg_s)",
    .symptom =
        "a residual of the sign of the speed whose size decays with the time of the log, whatever the motion",
    .look_alikes = look_alikes,
    .source =
        "Bittencourt and Axelsson, IEEE/ASME Transactions on Mechatronics 19, 2014, for friction and "
        "temperature; Newton's law of cooling for the time",
    .side = Side::joint,
    .domain = Domain::speed,
    .parameters = parameters,
    .apply = apply,
};

}  // namespace ripplenotch
