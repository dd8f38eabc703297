// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/functions/many_numbers.hpp"
#include "model/effects.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

// The direction in which the joint last clearly moved: -1, 1, or 0 before it first did.
class HeldDirection {
  public:
    static constexpr double clear_deg_s = 0.5;  // chosen, not derived
    int update(double velocity_deg_s) {
        if (std::abs(velocity_deg_s) > clear_deg_s) held_ = velocity_deg_s > 0.0 ? 1 : -1;
        return held_;
    }

  private:
    int held_ = 0;
};

}  // namespace

const Effect effects::hysteresis{
    .name = "hysteresis",
    .summary = "soft wind-up of the gear: after a reversal the friction torque turns over within an angle",
    .equation =
        "torque = torque_nm * z, dz/dq = (1 - z * direction) / width_deg, z = initial_state at the start",
    .symptom =
        "a residual that after each reversal goes from one side to the other over an angle, not over a time, "
        "and stays at rest",
    .look_alikes = {{"coulomb-friction",
                     "every reversal is quick, or the width is below what the position resolves",
                     "slow reversals: hysteresis builds up over an angle, Coulomb friction at once"},
                    {"offset", "the joint moves one way only", "a log that reverses"},
                    {"gravity", "the width is as large as the travel", "a longer travel"}},
    .source = "Dahl, 1968; for harmonic drives Taghirad and Belanger, 1998; Tuttle, 1992",
    .domain = Domain::position,
    .parameters = {linear("torque_nm", "Nm", "half the width of the loop", {0.5, 0.0, 1e5}),
                   reversal_width_parameter("angle after a reversal in which 63 % of the change is made"),
                   initial_state_parameter()},
    .resists = true,
    .apply = [](const Situation& situation, Values values, Torques torque_nm) {
        const Motion& motion = situation.motion;
        // Within one direction the state depends on the angle gone since the reversal alone, so that noise on
        // the position does not ratchet it along.
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
    }};

const Effect effects::backlash{
    .name = "backlash",
    .summary = "lost motion: after a reversal the torque is missing until the play has been traversed",
    .equation =
        "torque = torque_nm * z^3, dz/dq = 2 / width_deg within -1 <= z <= 1 and 0 at its ends, z = "
        "initial_state at the start",
    .symptom =
        "a residual that after each reversal falls to zero, stays there over an angle and builds up with the "
        "other sign",
    .look_alikes =
        {{"hysteresis",
          "the play is small against the angle between samples, or the noise is as large as the torque",
          "slow reversals: play has a range of angle without torque, hysteresis approaches its limit "
          "exponentially"},
         {"coulomb-friction", "every reversal is quick and is followed by no rest",
          "slow reversals and rests: Coulomb friction is gone at rest, and there at once in motion"},
         {"offset", "the joint moves one way only", "a log that reverses"}},
    .source =
        "Nordin and Gutman, Automatica 38, 2002, for play; Tuttle, 1992, for a stiffness that grows with the "
        "cube of the twist",
    .domain = Domain::position,
    .parameters = {linear("torque_nm", "Nm", "torque that the flanks carry beyond the play", {0.5, 0.0, 1e5}),
                   reversal_width_parameter("play: angle from the contact of one flank to that of the other"),
                   initial_state_parameter()},
    .apply = [](const Situation& situation, Values values, Torques torque_nm) {
        const std::vector<double>& position_deg = situation.motion.position_deg;
        const double states_per_deg = 2.0 / values[1];
        double state = values[2];
        for (std::size_t k = 0; k < torque_nm.size(); ++k) {
            const double gone_deg = position_deg[k] - position_deg[k > 0 ? k - 1 : 0];
            state = std::clamp(state + states_per_deg * gone_deg, -1.0, 1.0);
            torque_nm[k] += values[0] * state * state * state;
        }
    }};

const Effect effects::start_stop_ringing{
    .name = "start-stop-ringing",
    .summary = "a load on a spring swings when the acceleration of the joint changes",
    .equation =
        "torque = sum over changes of the acceleration of change / (100 deg/s2) * amplitude_nm * exp(-s / "
        "decay_s) * cos(360 deg * frequency_hz * s + phase_deg), s = time since",
    .symptom =
        "a residual that swings and decays after each start, stop and end of an acceleration, the other way "
        "round in the other direction",
    .look_alikes = {{"stribeck-friction", "every slow sample belongs to a start or a stop",
                     "a long pass at low speed"},
                    {"inertia", "the acceleration was smoothed more than the start lasts",
                     "a shorter smoothing, or a slower start"},
                    {"tone", "it decays slowly and the log has few starts",
                     "a rest as long as several decays"}},
    .source =
        "the answer of a lightly damped mass to a step; both ends of the move in Kim, Kim, Song, Trans. KSME "
        "A, 2011, fig. 11",
    .domain = Domain::time,
    .parameters = {linear("amplitude_nm", "Nm", "zero to peak just after the acceleration grew by 100 deg/s2",
                          {0.5, 0.0, 1e5}),
                   plain("phase_deg", "deg", "of the cosine at the change", {0.0, -360.0, 360.0}),
                   logarithmic("frequency_hz", "Hz", "of the ringing", {5.0, 0.05, 1e4, 5.0}),
                   logarithmic("decay_s", "s", "time in which it falls to 37 %",
                               {0.5, 0.001, 100.0, 0.5})},  // chosen, not derived
    .polar = Polar{0, 1},
    .apply = [](const Situation& situation, Values values, Torques torque_nm) {
        const std::vector<double>& acceleration = situation.motion.acceleration_deg_s2;
        const double step_s = 1.0 / situation.motion.sample_rate.value();
        const double turn_deg = 360.0 * values[2] * step_s;
        const double shrink = portable::exp(-std::min(step_s / values[3], 700.0));
        const double turn_real = shrink * portable::cos_degrees(turn_deg),
                     turn_imaginary = shrink * portable::sin_degrees(turn_deg);
        const double cosine = portable::cos_degrees(values[1]), sine = portable::sin_degrees(values[1]);
        double real = 0.0, imaginary = 0.0;
        for (std::size_t k = 1; k < torque_nm.size(); ++k) {
            const double turned = real * turn_real - imaginary * turn_imaginary;
            imaginary = real * turn_imaginary + imaginary * turn_real;
            real = turned + 0.01 * (acceleration[k] - acceleration[k - 1]);
            torque_nm[k] += values[0] * (real * cosine - imaginary * sine);
        }
    }};

}  // namespace ripplenotch
