// SPDX-License-Identifier: MIT
#pragma once
// Spectra and maps over speed as figures.

#include <optional>
#include <span>
#include <string>

#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/analysis/line_search.hpp"
#include "ripplenotch/analysis/order_map.hpp"
#include "ripplenotch/analysis/spectrum.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/figure/figure.hpp"

namespace ripplenotch {

/// Line frequency against speed with the fitted ratio, the residual of the fit, and amplitude against speed:
/// of the orders by direction with 95 % intervals, without a ratio of the lines.
[[nodiscard]] Figure identification_figure(const std::string& source, const Identification& identification);

/// The largest amplitude of each motor (along x) in each torque (along y), by the numbers of the joints;
/// cells where nothing was found are empty.
[[nodiscard]] Figure motor_matrix_figure(const std::string& source, std::span<const Identification> joints);

/// Lines that get their name in a spectrum, strongest first.
inline constexpr std::size_t max_named_lines = 12;

/// Amplitude against frequency with the noise floor, lines named by frequency and amplitude.
/// `smears_orders`: as Stretch::smears_orders.
[[nodiscard]] Figure spectrum_figure(const std::string& source, const Spectrum& spectrum, bool smears_orders);

/// Amplitude against output order, order lines named.
[[nodiscard]] Figure order_spectrum_figure(const std::string& source, const Stack& stack,
                                           const MotionLines& lines);

/// Campbell diagram or order map: speed along x. With a gear the lines of its orders are drawn;
/// `axis_per_motor_turn`: the map's own orders are per motor turn, not per output turn.
struct MapLines {
    std::optional<GearAccount> gear;
    bool axis_per_motor_turn = false;
};
[[nodiscard]] Figure speed_map_figure(const std::string& source, const SpeedMap& map, const MapLines& lines);

}  // namespace ripplenotch
