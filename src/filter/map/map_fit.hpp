// SPDX-License-Identifier: MIT
#pragma once
#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "filter/ripple_keys.hpp"
#include "ripplenotch/analysis/sweeps.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/design/ripple_map.hpp"
#include "ripplenotch/filter/map_fit.hpp"

namespace ripplenotch {

// What a map is fitted to: the amplitudes of every few periods of the lowest order of all logs, in blocks.

/// Amplitudes of all orders in a window, in the form of RippleMap.
struct MapWindow {
    MapState state;  ///< means
    std::vector<std::complex<double>> value;
    std::vector<double> noise;  ///< by order: mean square of the noise in `value`
    std::size_t block = 0, log = 0;
    SampleRun rows;
    bool scored = true;                 ///< it shares no sample with another block
};

/// Blocks are windows in a row, of one log each.
struct MapData {
    std::vector<MapWindow> windows;
    RippleMap frame;       ///< gear ratio, orders, zero and the ranges of the windows, without values
    RippleOrders counted;  ///< the orders by which windows are cut and their turns count
    std::size_t blocks = 0;
};

/// Angles count from `zero_deg`.
[[nodiscard]] MapData map_data(std::span<const TraceView> logs, const GearAccount& gear, double zero_deg);

/// Finding, scores, notes and the form of the map, of data that have a window. `false_alarm`: probability
/// that a log without ripple has a map. Where `fit` is not anchored the joint's own angle is not known, and a
/// second comb means nothing.
void choose_map(const MapData& data, double false_alarm, MapFit& fit);

}  // namespace ripplenotch
