// SPDX-License-Identifier: MIT
#pragma once
// Which orders are ripple, and the form of their map: by blocks of windows that are left out of the fit.

#include <string>
#include <vector>

#include "filter/map/map_data.hpp"

namespace ripplenotch {

/// Squares of one order in left-out blocks, in Nm^2 as means over the windows.
struct HeldOut {
    double total = 0.0, noise = 0.0;
    /// Beside the map. Each block is predicted by the form that the other blocks choose, so that the choice
    /// does not flatter it.
    double residual = 0.0;
};

struct MapChoice {
    MapForm form;
    std::vector<HeldOut> held_out;      ///< by order of the data
    std::vector<bool> present;          ///< by order of the data: ripple, at the false-alarm rates below
    std::vector<double> errors_better;  ///< by order of the data: reduction of squares in its standard errors
    std::vector<double> false_alarm;    ///< by order of the data: probability of such ripple by chance
    std::vector<std::string> notes;
};

/// The probability that a map has an order although no order is there, and that it has another order beside
/// one.
inline constexpr double map_false_alarm = 0.01, other_order_false_alarm = 0.05;

/// `tied` states whether the joint's own angle is known, so that columns by that angle mean something.
[[nodiscard]] MapChoice choose_map(const MapData& data, bool tied);

/// The amplitude of an order, Nm, that is found in 20 of 20 logs like this one that hold it: alike at every
/// speed, at a random phase, beside the log's own amplitudes with the phases of its blocks drawn at random.
/// Infinity where there is none.
[[nodiscard]] double detectable_amplitude(const MapData& data, std::size_t order, bool tied);

}  // namespace ripplenotch
