// SPDX-License-Identifier: MIT
#include <algorithm>
#include <vector>

#include "model/effects.hpp"

namespace ripplenotch {
namespace {

// Places at which a screening of a log begins.
constexpr double tried_widths[] = {0.2, 0.5, 1.0, 2.0, 4.0, 8.0};

constexpr Parameter parameters[] = {
    {.name = "torque_nm",
     .unit = "Nm",
     .help = "torque that the flanks carry beyond the play",
     .start = 0.5,
     .upper = 1e5,
     .linear = true},
    reversal_width_parameter("play: angle from the contact of one flank to that of the other", tried_widths),
    initial_state_parameter,
};

constexpr LookAlike look_alikes[] = {
    {"hysteresis",
     "the play is small against the angle between samples, or the noise is as large as the "
     "torque",
     "slow reversals: play has a range of angle without torque, hysteresis approaches its limit "
     "exponentially"},
    {"coulomb-friction", "every reversal is quick and is followed by no rest",
     "slow reversals and rests: Coulomb friction is gone at rest, and there at once in motion"},
    {"offset", "the joint moves one way only", "a log that reverses"},
};

void apply(const Situation& situation, std::span<const double> values, std::span<double> torque_nm) {
    const std::vector<double>& position_deg = situation.motion.position_deg;
    const double states_per_deg = 2.0 / values[1];
    double state = values[2];
    for (std::size_t k = 0; k < torque_nm.size(); ++k) {
        const double gone_deg = position_deg[k] - position_deg[k > 0 ? k - 1 : 0];
        state = std::clamp(state + states_per_deg * gone_deg, -1.0, 1.0);
        torque_nm[k] += values[0] * state * state * state;
    }
}

}  // namespace

const Effect effects::backlash{
    .name = "backlash",
    .summary = "lost motion: after a reversal the torque is missing until the play has been traversed",
    .equation =
        "torque = torque_nm * z^3, dz/dq = 2 / width_deg within -1 <= z <= 1 and 0 at its ends, z = "
        "initial_state at the start",
    .symptom =
        "a residual that after each reversal falls to zero, stays there over an angle and builds up with the "
        "other sign",
    .look_alikes = look_alikes,
    .source =
        "Nordin and Gutman, Automatica 38, 2002, for play; Tuttle, 1992, for a stiffness that grows with the "
        "cube of the twist",
    .side = Side::joint,
    .domain = Domain::position,
    .parameters = parameters,
    .apply = apply,
};

}  // namespace ripplenotch
