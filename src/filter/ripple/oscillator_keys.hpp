// SPDX-License-Identifier: MIT
#pragma once
// Keys of the method oscillator.

#include <array>
#include <string_view>

#include "filter/map/map_settings.hpp"
#include "filter/ripple/ripple_keys.hpp"

namespace ripplenotch {

inline constexpr std::array<std::string_view, 2> oscillator_gains = {"exact", "scheduled"};
inline constexpr std::array<std::string_view, 2> oscillator_outputs = {"torque", "minus-ripple"};
inline constexpr std::array<std::string_view, 2> oscillator_zeros = {"known", "unknown"};

inline constexpr std::array oscillator_own_keys = {
    gear_ratio_key,
    orders_key,
    joint_key,
    Key{.name = "bandwidth",
        .dimension = Dimension::frequency,
        .default_text = "15Hz",
        .above = 0.0,
        .help = "of the torque: what is faster and no ripple counts as noise"},
    Key{.name = "memory",
        .above = 0.0,
        .at_most = 1e6,
        .help = "motor turns over which the ripple's amplitude may change; 0.5, and with a map 0.15"},
    Key{.name = "amplitudes",
        .kind = KeyKind::list,
        .dimension = Dimension::torque,
        .at_least = 0.0,
        .help = "warm start: zero to peak, one per order, e.g. 0.8Nm:0.5Nm"},
    Key{.name = "phases",
        .kind = KeyKind::list,
        .dimension = Dimension::angle,
        .help =
            "warm start: of cos(n motor angle + phase), one per order; the motor angle is gear ratio times "
            "position"},
    Key{.name = "trust",
        .default_text = "0.1",
        .above = 0.0,
        .at_most = 10.0,
        .help = "warm start: how far amplitudes and phases may be off, as a share of the amplitude"},
    Key{.name = "noise",
        .dimension = Dimension::torque,
        .default_text = "0.05Nm",
        .above = 0.0,
        .help = "rms noise of the sensor"},
    Key{.name = "largest",
        .dimension = Dimension::torque,
        .default_text = "1Nm",
        .above = 0.0,
        .help = "cold start: amplitude that an order may well have"},
    Key{.name = "gain",
        .kind = KeyKind::choice,
        .default_text = "exact",
        .choices = oscillator_gains,
        .help =
            "exact: worked out at every sample; scheduled: the settled one of the present speed, cheaper, "
            "slower to start"},
    Key{.name = "rest",
        .dimension = Dimension::torque,
        .help =
            "torque that the joint is known to bear where a log begins at standstill, 0Nm for an unloaded "
            "arm: the rest is ripple"},
    angle_key,
    Key{.name = "start",
        .dimension = Dimension::angle,
        .help = "position at the first row of a log without one, so that phases mean something"},
    Key{.name = "offset",
        .dimension = Dimension::speed,
        .default_text = "2deg/s",
        .above = 0.0,
        .help = "angle from velocity: largest offset of the velocity that the ripple may correct"},
    Key{.name = "jump",
        .default_text = "0",
        .at_least = 0.0,
        .at_most = 1e6,
        .help = "a sample that is off by more than this many of its deviations is a jump of the torque, not "
                "ripple; "
                "0: none is"},
    Key{.name = "slip",
        .default_text = "0.03",
        .at_least = 0.0,
        .at_most = 0.2,
        .help = "angle from position: largest share by which the ripple may correct the gear ratio"},
    Key{.name = "output",
        .kind = KeyKind::choice,
        .default_text = "torque",
        .choices = oscillator_outputs,
        .help = "torque: the estimate, smoothed; minus-ripple: the log's own torque less the ripple"},
};
inline constexpr std::array oscillator_map_keys = {
    Key{.name = "zero",
        .kind = KeyKind::choice,
        .default_text = "known",
        .choices = oscillator_zeros,
        .help = "with a map: unknown finds the motor's angle anew within one turn, as after a new encoder"},
    Key{.name = "return",
        .default_text = "5",
        .above = 0.0,
        .at_most = 1e6,
        .help = "with a map: motor turns over which what was followed is forgotten towards the map"},
};

inline constexpr auto oscillator_keys =
    joined_keys(oscillator_own_keys, ripple_map_keys, oscillator_map_keys);

}  // namespace ripplenotch
