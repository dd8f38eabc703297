// SPDX-License-Identifier: MIT
#pragma once
// Methods whose coefficients change while they run, as the numbers that they run on: what an export has to
// write down.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "ripplenotch/design/candidate_table.hpp"
#include "ripplenotch/design/ripple_map.hpp"

namespace ripplenotch {

/// What becomes of the filters' memories at a switch, unless it is stated: in `filter` and `compare` as in
/// exported code. On the six moving joints of a robot's log this one leaves the least error in 50 of 72 cases
/// (docs/methods/switching.md), and it runs one filter, whatever the number of bands.
inline constexpr std::string_view default_transition = "keep-state-variable";

/// How the bands of a table take turns (docs/methods/switching.md).
struct SwitchingDesign {
    OutsideRule below = OutsideRule::pass;  ///< below the first band, and in a hole between bands
    OutsideRule above = OutsideRule::hold;
    DegPerSec hysteresis{0.0};      ///< a region is left only when |v| is this far outside it; 0 as the paper
    std::size_t dwell_samples = 0;  ///< a candidate stays at least this long
    std::string transition{default_transition};
    std::size_t crossfade_samples = 0;  ///< of transition crossfade
};

/// One notch per order, retuned at every sample (docs/methods/tracking.md).
struct TrackingDesign {
    double gear_ratio = 0.0, sample_rate_hz = 0.0;
    std::vector<double> orders, weights;
    std::vector<double> spread;  ///< centres of the composite's notches, relative to the order's
    double q_each = 0.0;
    double narrow_hz = 0.0;   ///< lines below this get a narrower notch, in proportion
    double depth_gain = 0.0;  ///< at the centre, with full share
    double min_hz = 0.0, fade_hz = 0.0;
    bool parks = false;
    double speed_pole = 0.0;  ///< pole of the low-pass on the speed, 0 for none
    double slew = 1.0;        ///< 1 for none
};

/// For how many periods of the lowest order the oscillator gives the torque as it is measured, less the
/// ripple of its map: a torque that rises while the motor has hardly turned cannot be distinguished from
/// ripple. Then what it has learnt is faded in. Chosen by measurement: docs/methods/oscillator.md#starting.
struct OscillatorWait {
    static constexpr double from = 0.5, until = 1.0;
};

/// A Kalman filter of torque and ripple with its gain computed at every sample (docs/methods/oscillator.md).
struct OscillatorDesign {
    /// In units of the noise.
    struct Prior {
        double cosine = 0.0, sine = 0.0, deviation = 0.0;
    };
    double gear_ratio = 0.0;  ///< turns of the angle that is handed over, in a turn of the joint
    std::vector<double> orders;
    std::vector<Prior> priors;
    double step_s = 0.0, noise_nm = 0.0;
    double torque_noise = 0.0, cross_noise = 0.0, rate_noise = 0.0;  ///< increments of variance in a sample
    double first_rate_variance = 0.0;
    double memory_turns = 0.0;  ///< of that angle, as return_turns
    double return_turns = 0.0;  ///< turns over which amplitudes decay towards 0; 0: never
    double jump = 0.0;          ///< 0: never
    double largest_slip = 0.0;
    bool waits = false;  ///< OscillatorWait
    bool minus_ripple = false;
    /// Subtracted first, its angles counted from position 0: the amplitudes are those of the remaining
    /// ripple.
    std::optional<RippleMap> map = std::nullopt;
};

/// Every order is whole: the angle within a turn does.
[[nodiscard]] inline bool repeats_each_turn(const std::vector<double>& orders) {
    return std::all_of(orders.begin(), orders.end(), [](double order) { return order == std::floor(order); });
}

using RunningDesign = std::variant<TrackingDesign, OscillatorDesign>;

}  // namespace ripplenotch
