// SPDX-License-Identifier: MIT
#pragma once
// A flat map as a table over one motor turn.

#include <array>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/design/ripple_map.hpp"

namespace ripplenotch {

// A map for targets that hold one amplitude and phase an order.

inline constexpr Key flat_speed_key{
    .name = "speed",
    .dimension = Dimension::speed,
    .at_least = 0.0,
    .help = "joint speed whose amplitudes are taken; the middle of the map's"};
inline constexpr Key flat_direction_key{.name = "direction",
                                        .default_text = "both",
                                        .choices = "both forward backward",
                                        .help = "both: the mean of the two"};

/// The map at one speed and direction, alike at all of them, without the second comb and orders that are not
/// whole.
[[nodiscard]] RippleMap flat_map(const RippleMap& map, const Settings& settings);

/// The parts of the map that its flat form omits, one sentence each. Throws UsageError for a map without a
/// gear ratio.
[[nodiscard]] std::vector<std::string> flattened(const RippleMap& map, std::string_view target);

/// Amplitude and phase of r cos(n theta + phase), degrees from 0 to 360.
struct AmplitudePhase {
    double amplitude_nm = 0.0, phase_deg = 0.0;
};
[[nodiscard]] AmplitudePhase amplitude_phase(std::complex<double> value);
/// The inverse.
[[nodiscard]] std::complex<double> value_of(const AmplitudePhase& one);

/// Entry k is the ripple at k / entries of a turn. Orders that are no whole numbers do not close: they are
/// those of the turn that begins at 0.
[[nodiscard]] std::vector<double> turn_table(const RippleMap& flat, std::size_t entries);

/// The largest error of linear interpolation in such a table: the second derivative's bound.
[[nodiscard]] double interpolation_bound_nm(const RippleMap& flat, std::size_t entries);

/// The ripple by linear interpolation, in float.
[[nodiscard]] std::function<double(const MapState&)> table_torque(std::vector<double> table,
                                                                  const RippleMap& map);

}  // namespace ripplenotch
