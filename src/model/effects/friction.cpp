// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "model/effects.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

const Effect effects::coulomb_friction{
    .name = "coulomb-friction",
    .summary = "friction of constant size against the motion, behind the sensor",
    .equation = "torque = torque_nm * tanh(v / width_deg_s)",
    .symptom = "a residual that changes sign with the direction of motion and does not depend on the speed",
    .look_alikes = {{"offset", "the joint moves one way only and never rests",
                     "a log that reverses, or rests"},
                    {"hysteresis", "every reversal is quick",
                     "slow reversals: hysteresis builds up over an angle, Coulomb friction at once"},
                    {"viscous-friction", "there is one speed in each direction",
                     "two speeds in the same direction"}},
    .source = "Coulomb; Olsson et al., European Journal of Control 4, 1998, for the smoothed form",
    .domain = Domain::speed,
    .parameters = {linear("torque_nm", "Nm", "friction torque while the joint moves, as the sensor sees it",
                          {0.5, 0.0, 1e5}),
                   logarithmic(
                       "width_deg_s", "deg/s",
                       "speed at which 76 % of it has built up; logs of steady motion do not determine it",
                       {0.2, 0.001, 100.0, 0.2})},
    .resists = true,
    .apply = [](const Situation& situation, Values values, Torques torque_nm) {
        with_directions(situation.motion, values[1],
                        [&](std::size_t k, double step) { torque_nm[k] += values[0] * step; });
    }};

const Effect effects::asymmetric_friction{
    .name = "asymmetric-friction",
    .summary = "Coulomb friction whose level differs between the two directions of motion",
    .equation = "torque = difference_nm / 2 * tanh(v / width_deg_s)^2",
    .symptom = "an offset in the residual that is the same in both directions of motion and absent at rest",
    .look_alikes = {{"coulomb-friction", "the joint moves one way only", "a log that reverses, and rests"},
                    {"offset", "the joint never rests, or all rests are short",
                     "reversals, and standstill of a second or more: an offset stays at rest, a difference "
                     "of friction does not"},
                    {"gravity",
                     "the travel is a small part of a turn, or a direction goes with a range of positions",
                     "the same positions passed in both directions, and standstill at several positions"},
                    {"quadratic-viscous-friction", "the joint moves one way only", "a log that reverses"}},
    .source =
        "Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30, 1994, for friction that depends on the "
        "direction",
    .domain = Domain::speed,
    .parameters = {linear("difference_nm", "Nm",
                          "friction torque in positive motion less that in negative motion",
                          {0.3, -1e5, 1e5}),
                   assumed(logarithmic("width_deg_s", "deg/s", "speed at which 58 % of it has built up",
                                       {0.2, 0.001, 100.0, 0.2}))},
    .apply = [](const Situation& situation, Values values, Torques torque_nm) {
        with_directions(situation.motion, values[1],
                        [&](std::size_t k, double step) { torque_nm[k] += 0.5 * values[0] * step * step; });
    }};

const Effect effects::viscous_friction{
    .name = "viscous-friction",
    .summary = "friction in proportion to the speed, behind the sensor",
    .equation = "torque = coefficient_nm_per_deg_s * v",
    .symptom = "a residual in proportion to the speed, of its sign",
    .look_alikes = {{"quadratic-viscous-friction", "fewer than three speeds are in the log",
                     "three speeds, the fastest five times the slowest"},
                    {"coulomb-friction", "there is one speed in each direction",
                     "two speeds in the same direction"},
                    {"gravity", "the log is one smooth stroke",
                     "the same positions passed at two speeds, or in both directions"}},
    .source = "Olsson et al., European Journal of Control 4, 1998",
    .domain = Domain::speed,
    .parameters = {linear("coefficient_nm_per_deg_s", "Nm/(deg/s)",
                          "friction torque per unit of speed, as the sensor sees it", {0.005, 0.0, 1e4})},
    .resists = true,
    .apply = [](const Situation& situation, Values values, Torques torque_nm) {
        for (std::size_t k = 0; k < torque_nm.size(); ++k)
            torque_nm[k] += values[0] * situation.motion.velocity_deg_s[k];
    }};

const Effect effects::asymmetric_viscous_friction{
    .name = "asymmetric-viscous-friction",
    .summary = "viscous friction whose coefficient differs between the two directions of motion",
    .equation = "torque = difference_nm_per_deg_s / 2 * |v|",
    .symptom = "a residual in proportion to the speed, of the same sign in both directions of motion",
    .look_alikes = {{"asymmetric-friction", "there is one speed in each direction",
                     "two speeds in each direction, the fastest five times the slowest"},
                    {"offset", "the joint never rests, and has one speed in each direction",
                     "standstill, or two speeds in each direction"},
                    {"viscous-friction", "the joint moves one way only", "a log that reverses"},
                    {"quadratic-viscous-friction", "the joint moves one way only",
                     "a log that reverses, at three speeds"},
                    {"gravity", "the log is one smooth stroke",
                     "the same positions passed at two speeds, or in both directions"}},
    .source =
        "Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30, 1994, for friction that depends on the "
        "direction; Janot, Gautier, Brunot, 2019, for a linear axis that has it (EMPS)",
    .domain = Domain::speed,
    .parameters = {linear("difference_nm_per_deg_s", "Nm/(deg/s)",
                          "viscous friction coefficient in positive motion less that in negative motion",
                          {0.002, -1e4, 1e4})},
    .differs = true,
    .apply = [](const Situation& situation, Values values, Torques torque_nm) {
        for (std::size_t k = 0; k < torque_nm.size(); ++k)
            torque_nm[k] += 0.5 * values[0] * std::abs(situation.motion.velocity_deg_s[k]);
    }};

const Effect effects::quadratic_viscous_friction{
    .name = "quadratic-viscous-friction",
    .summary = "friction that grows with the square of the speed",
    .equation = "torque = coefficient_nm_per_deg2_s2 * v * |v|",
    .symptom = "a residual that curves with the speed, of its sign",
    .look_alikes = {{"viscous-friction", "fewer than three speeds are in the log",
                     "three speeds, the fastest five times the slowest"},
                    {"gravity", "the log is one smooth stroke",
                     "the same positions passed at two speeds, or in both directions"}},
    .source =
        "windage and churning of grease; Bittencourt et al., 2010, for friction that is not in proportion to "
        "the speed",
    .domain = Domain::speed,
    .parameters = {linear("coefficient_nm_per_deg2_s2", "Nm/(deg/s)2",
                          "friction torque per square of the speed; below 0 together with viscous-friction, "
                          "for friction that saturates",
                          {1e-5, -1e3, 1e3})},
    .apply = [](const Situation& situation, Values values, Torques torque_nm) {
        for (std::size_t k = 0; k < torque_nm.size(); ++k) {
            const double v = situation.motion.velocity_deg_s[k];
            torque_nm[k] += values[0] * v * std::abs(v);
        }
    }};

const Effect effects::stribeck_friction{
    .name = "stribeck-friction",
    .summary = "static friction: more torque to move slowly than to move",
    .equation = "torque = torque_nm * tanh(v / width_deg_s) * exp(-(v / stribeck_speed_deg_s)^2)",
    .symptom = "a residual of the sign of the speed, at low speed only: at both ends of a move",
    .look_alikes = {{"coulomb-friction", "no sample moves slower than the Stribeck speed, or none faster",
                     "passes at several speeds from a tenth of the Stribeck speed to ten times it"},
                    {"start-stop-ringing", "every slow sample belongs to a start or a stop",
                     "a long pass at low speed"},
                    {"hysteresis", "every slow sample belongs to a reversal", "a long pass at low speed"}},
    .source =
        "Stribeck, 1902; Olsson et al., European Journal of Control 4, 1998; both ends of the move in Kim, "
        "Kim, Song, Trans. KSME A, 2011, fig. 11",
    .domain = Domain::speed,
    .parameters = {linear("torque_nm", "Nm",
                          "friction torque just above standstill, beyond what is there at speed",
                          {0.5, 0.0, 1e5}),
                   logarithmic("stribeck_speed_deg_s", "deg/s", "speed at which 37 % of it remains",
                               {10.0, 0.05, 1000.0, 10.0}, {3.0, 5.0, 8.0, 12.0, 18.0, 30.0, 60.0}),
                   width_parameter()},
    .resists = true,
    .apply = [](const Situation& situation, Values values, Torques torque_nm) {
        const auto& velocity_deg_s = situation.motion.velocity_deg_s;
        const auto exponent = [&](std::size_t k) {
            const double relative = std::min(std::abs(velocity_deg_s[k]) / values[1], 26.0);
            return -relative * relative;
        };
        with_two_values(
            torque_nm.size(), [&](std::size_t k) { return velocity_deg_s[k] / values[2]; },
            portable::many_tanh, exponent, portable::many_exp,
            [&](std::size_t k, double step, double left) { torque_nm[k] += values[0] * step * left; });
    }};

const Effect effects::load_friction{
    .name = "load-friction",
    .summary = "friction that grows with the torque that gear and bearings carry",
    .equation =
        "torque = torque_nm * (|load| / 1 Nm)^exponent * tanh(v / width_deg_s), load = torque of inertia and "
        "gravity",
    .symptom =
        "a residual of the sign of the speed that is largest where the joint accelerates or holds a weight",
    .look_alikes = {{"inertia", "the joint moves one way only", "a log that reverses"},
                    {"coulomb-friction", "the load hardly changes while the joint moves",
                     "moves of different acceleration, or over a larger part of the turn"},
                    {"ripple-load-dependence", "the ripple is faster than the sample rate shows",
                     "a slower move"}},
    .source = "Bittencourt et al., 2010; Wolf and Iskandar, 2018",
    .domain = Domain::speed,
    .parameters = {linear("torque_nm", "Nm", "friction torque at a load of 1 Nm", {0.05, 0.0, 1e4}),
                   plain("exponent", "", "how it grows with the load; 1 is in proportion",
                         {1.0, 0.2, 4.0, 1.0}),
                   width_parameter()},
    .uses_load = true,
    .resists = true,
    .apply = [](const Situation& situation, Values values, Torques torque_nm) {
        const auto& velocity_deg_s = situation.motion.velocity_deg_s;
        const auto raise = [&](std::span<double> loads) { portable::pow(loads, values[1], loads); };
        with_two_values(
            torque_nm.size(), [&](std::size_t k) { return std::abs(situation.load_nm[k]); }, raise,
            [&](std::size_t k) { return velocity_deg_s[k] / values[2]; }, portable::many_tanh,
            [&](std::size_t k, double load, double step) { torque_nm[k] += values[0] * load * step; });
    }};

const Effect effects::position_dependent_friction{
    .name = "position-dependent-friction",
    .summary = "Coulomb friction that changes with the output angle: misalignment or uneven preload",
    .equation = "torque = amplitude_nm * cos(order * q + phase_deg) * tanh(v / width_deg_s)",
    .symptom =
        "a residual at the same positions in both directions with opposite sign, order cycles per output "
        "revolution",
    .look_alikes = {{"coulomb-friction", "the travel is a small part of a cycle",
                     "a travel of a whole output revolution"},
                    {"output-ripple", "each position is passed in one direction only",
                     "the same positions in both directions: ripple keeps its sign, friction does not"},
                    {"gravity", "each position is passed in one direction only",
                     "the same positions in both directions, and standstill at several positions"},
                    {"load-friction", "gravity makes the load follow the position",
                     "the same positions with another load"}},
    .source =
        "Popovic and Goldenberg, IEEE Transactions on Robotics and Automation 14, 1998; Armstrong, 1988, for "
        "friction by position",
    .domain = Domain::position,
    .parameters = {cycles_parameter("order", "cycles per output revolution", 1.0, 1e4),
                   cosine_amplitude_parameter(), cosine_phase_parameter(), width_parameter()},
    .polar = Polar{1, 2},
    .apply = [](const Situation& situation, Values values, Torques torque_nm) {
        const Motion& motion = situation.motion;
        with_two_values(
            torque_nm.size(), [&](std::size_t k) { return values[0] * motion.position_deg[k] + values[2]; },
            cosines_of, [&](std::size_t k) { return motion.velocity_deg_s[k] / values[3]; },
            portable::many_tanh,
            [&](std::size_t k, double cosine, double step) { torque_nm[k] += values[1] * cosine * step; });
    }};

const Effect effects::friction_warm_up{
    .name = "friction-warm-up",
    .summary = "friction that changes while the gear and its grease warm up",
    .equation = "torque = change_nm * exp(-t / time_constant_s) * tanh(v / width_deg_s)",
    .symptom =
        "a residual of the sign of the speed whose size decays with the time of the log, whatever the motion",
    .look_alikes = {{"coulomb-friction", "the log is short against the time constant",
                     "a log several times as long as the time constant, from a cold start"},
                    {"drift", "the joint moves one way only",
                     "a log that reverses: drift keeps its sign, friction does not"},
                    {"viscous-friction", "the speed only grows or only falls",
                     "the same speed early and late in the log"}},
    .source =
        "Bittencourt and Axelsson, IEEE/ASME Transactions on Mechatronics 19, 2014, for friction and "
        "temperature; Newton's law of cooling for the time",
    .domain = Domain::speed,
    .parameters = {linear("change_nm", "Nm",
                          "friction torque when the log begins, beyond that of the warm gear",
                          {0.5, -1e5, 1e5}),
                   logarithmic("time_constant_s", "s", "after which 37 % of the change remains",
                               {30.0, 0.5, 1e5, 1.0}),
                   width_parameter()},
    .apply = [](const Situation& situation, Values values, Torques torque_nm) {
        const Motion& motion = situation.motion;
        const auto exponent = [&](std::size_t k) {
            return -std::min((motion.time_s[k] - motion.time_s.front()) / values[1], 700.0);
        };
        with_two_values(
            torque_nm.size(), [&](std::size_t k) { return motion.velocity_deg_s[k] / values[2]; },
            portable::many_tanh, exponent, portable::many_exp,
            [&](std::size_t k, double step, double left) { torque_nm[k] += values[0] * step * left; });
    }};

const Effect effects::coupled_joint_friction{
    .name = "coupled-joint-friction",
    .summary = "friction of a motor that turns with this joint and another one: of a wrist, of a belt",
    .equation =
        "torque = torque_nm * tanh((v + ratio * v_joint) / width_deg_s) + coefficient_nm_per_deg_s * ratio * "
        "v_joint; what the coefficient makes of v is viscous-friction",
    .symptom = "a residual that turns over where another joint reverses, and changes with its speed",
    .look_alikes = {{"coulomb-friction", "the other joint rests or moves with this one",
                     "this joint in steady motion while the other one reverses"},
                    {"friction-warm-up", "the other joint moves in a part of the log",
                     "the other joint moves early and late in the log"},
                    {"hysteresis", "both joints reverse together",
                     "this joint in steady motion while the other one reverses"}},
    .source =
        "Staubli's wrists, whose axes 5 and 6 share a motor's friction: Gautier and Khalil, in FIGAROH's "
        "TX40",
    .domain = Domain::speed,
    .parameters = {linear("torque_nm", "Nm", "its Coulomb friction, as this joint bears it", {0.5, 0.0, 1e5}),
                   linear("coefficient_nm_per_deg_s", "Nm/(deg/s)",
                          "its viscous friction, as this joint bears it", {0.005, 0.0, 1e4}),
                   refused(plain("joint", "", "place of the other joint in the arm, from 1",
                                 {1.0, 1.0, 100.0, 1.0})),
                   plain("ratio", "",
                         "turns of the motor for a turn of the other joint, over those for one of this",
                         {1.0, -100.0, 100.0, 1.0}),
                   width_parameter()},
    .resists = true,
    .other_joint = 2,
    .apply = [](const Situation& situation, Values values, Torques torque_nm) {
        const Motion& motion = situation.motion;
        const auto joint = static_cast<std::size_t>(values[2]) - 1;
        const bool is_known = joint < motion.others_deg_s.size() && !motion.others_deg_s[joint].empty();
        const auto other = [&](std::size_t k) {
            return is_known ? values[3] * motion.others_deg_s[joint][k] : 0.0;
        };
        with_values(
            torque_nm.size(),
            [&](std::size_t k) { return (motion.velocity_deg_s[k] + other(k)) / values[4]; },
            portable::many_tanh,
            [&](std::size_t k, double step) { torque_nm[k] += values[0] * step + values[1] * other(k); });
    }};

}  // namespace ripplenotch
