// SPDX-License-Identifier: MIT
#include <algorithm>
#include <vector>

#include "core/functions/many_numbers.hpp"
#include "model/catalogue.hpp"
#include "model/effects.hpp"

namespace ripplenotch {
namespace {

// Places at which a screening of a log begins.
constexpr double tried_widths[] = {0.3, 0.7, 1.5, 3.0, 6.0, 12.0, 24.0};

constexpr Parameter parameters[] = {
    {.name = "torque_nm",
     .unit = "Nm",
     .help = "half the width of the loop",
     .start = 0.5,
     .upper = 1e5,
     .linear = true},
    reversal_width_parameter("angle after a reversal in which 63 % of the change is made", tried_widths),
    initial_state_parameter,
};

constexpr LookAlike look_alikes[] = {
    {"coulomb-friction", "every reversal is quick, or the width is below what the position resolves",
     "slow reversals: hysteresis builds up over an angle, Coulomb friction at once"},
    {"offset", "the joint moves one way only", "a log that reverses"},
    {"gravity", "the width is as large as the travel", "a longer travel"},
};

void apply(const Situation& situation, std::span<const double> values, std::span<double> torque_nm) {
    const Motion& motion = situation.motion;
    // Within one direction the state depends on the angle gone since the reversal alone, so that noise on the
    // position does not ratchet it along.
    std::vector<signed char> direction(torque_nm.size());
    std::vector<double> left(torque_nm.size());  // remaining share of the state at the last reversal
    HeldDirection direction_now;
    double reversal_deg = 0.0;
    for (std::size_t k = 0; k < torque_nm.size(); ++k) {
        const int held = direction_now.update(motion.velocity_deg_s[k]);
        if (held != (k > 0 ? direction[k - 1] : 0)) reversal_deg = motion.position_deg[k > 0 ? k - 1 : 0];
        direction[k] = static_cast<signed char>(held);
        const double gone_deg = std::max(held * (motion.position_deg[k] - reversal_deg), 0.0);
        left[k] = -std::min(gone_deg / values[1], 700.0);
    }
    portable::exp(left, left);
    double state = values[2], at_reversal = state;
    for (std::size_t k = 0; k < torque_nm.size(); ++k) {
        const int held = direction[k];
        if (held != (k > 0 ? direction[k - 1] : 0)) at_reversal = state;
        if (held != 0) state = held + (at_reversal - held) * left[k];
        torque_nm[k] += values[0] * state;
    }
}

}  // namespace

const Effect effects::hysteresis{
    .name = "hysteresis",
    .summary = "soft wind-up of the gear: after a reversal the friction torque turns over within an angle",
    .equation =
        "torque = torque_nm * z, dz/dq = (1 - z * direction) / width_deg, z = initial_state at the start",
    .symptom =
        "a residual that after each reversal goes from one side to the other over an angle, not over a time, "
        "and stays at rest",
    .look_alikes = look_alikes,
    .source = "Dahl, 1968; for harmonic drives Taghirad and Belanger, 1998; Tuttle, 1992",
    .side = Side::joint,
    .domain = Domain::position,
    .parameters = parameters,
    .resists = true,
    .apply = apply,
};

}  // namespace ripplenotch
