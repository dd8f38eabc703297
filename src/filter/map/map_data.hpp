// SPDX-License-Identifier: MIT
#pragma once
// What a map is fitted to: the amplitudes of every few motor turns of all logs, in blocks.

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/design/ripple_map.hpp"

namespace ripplenotch {

/// Amplitudes of all orders in a window, in the form of RippleMap.
struct MapWindow {
    MapState state;  ///< means
    std::vector<std::complex<double>> value;
    std::vector<double> noise;  ///< by order: mean square of what is no ripple in `value`
    std::size_t block = 0, log = 0;
    double middle = 0.0, length = 0.0;  ///< in motor turns along the log, back and forth added up
    bool scored = true;                 ///< it shares no sample with another block
};

/// Blocks are windows in a row, of one log each.
struct MapData {
    std::vector<MapWindow> windows;
    GearRatio gear_ratio;
    std::vector<Order> orders;
    std::size_t blocks = 0;
    std::vector<double> mean_noise, energy;  ///< by order: means over the windows of noise and |value|^2
    MapRange speeds_deg_s, positions_deg, loads_nm;
    MapRange temperatures_degc = {};  ///< 0 to 0 where a log has none
};

/// Angles count from `zero_deg`. Temperatures are of each log's rows, or empty where none is stated.
[[nodiscard]] MapData map_data(std::span<const TraceView> logs, const GearAccount& gear, double zero_deg,
                               std::span<const std::vector<double>> temperatures_degc = {});

/// The amplitudes of one order alone.
[[nodiscard]] MapData of_order(const MapData& data, std::size_t order);
/// Computes mean_noise and energy.
void summarise(MapData& data);

/// The windows of `data` that are, or are not, of one log; blocks keep their numbers.
[[nodiscard]] MapData of_log(const MapData& data, std::size_t log, bool is);

/// A map without values over the range of the data.
[[nodiscard]] RippleMap frame_of(const MapData& data, const MapForm& form, double zero_deg);

}  // namespace ripplenotch
