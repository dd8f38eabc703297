// SPDX-License-Identifier: MIT
#pragma once
// A map for targets that hold one amplitude and phase an order.

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/design/ripple_map.hpp"

namespace ripplenotch {

inline constexpr std::array<std::string_view, 3> flat_directions = {"both", "forward", "backward"};
inline constexpr Key flat_speed_key{
    .name = "speed",
    .dimension = Dimension::speed,
    .at_least = 0.0,
    .help = "joint speed whose amplitudes are taken; the middle of the map's"};
inline constexpr Key flat_direction_key{.name = "direction",
                                        .kind = KeyKind::choice,
                                        .default_text = "both",
                                        .choices = flat_directions,
                                        .help = "both: the mean of the two"};

inline constexpr Key flat_temperature_key{
    .name = "temperature",
    .at_least = -274.0,
    .at_most = 1000.0,
    .help = "in degC, whose amplitudes are taken; the middle of the map's"};

/// The map at one speed and direction, alike at all of them, without the joint's turn, at the middle load and
/// the stated temperature.
[[nodiscard]] RippleMap flat_map(const RippleMap& map, const Settings& settings);

/// What of the map is not in its flat form, one sentence each.
[[nodiscard]] std::vector<std::string> flattened(const RippleMap& map, std::string_view target);

/// Amplitude and phase of r cos(n theta + phase), degrees from 0 to 360.
struct AmplitudePhase {
    double amplitude_nm = 0.0, phase_deg = 0.0;
};
[[nodiscard]] AmplitudePhase amplitude_phase(std::complex<double> value);
/// The inverse.
[[nodiscard]] std::complex<double> value_of(const AmplitudePhase& one);

}  // namespace ripplenotch
