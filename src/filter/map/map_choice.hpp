// SPDX-License-Identifier: MIT
#pragma once
// The smallest form that the logs ask for, and the orders that are ripple, both by blocks left out.

#include <string>
#include <vector>

#include "filter/map/map_data.hpp"
#include "filter/map/map_regression.hpp"

namespace ripplenotch {

struct MapChoice {
    MapForm form;
    std::vector<HeldOut> scores;      ///< by order of the data
    std::vector<std::size_t> in_map;  ///< orders of the data whose ripple is more than chance
    std::vector<double> beyond;       ///< chance, in deviations; by order of the data
    std::vector<std::string> notes;   ///< what the simplest, the best and the chosen form leave
};

/// `tied` says whether the joint's own angle is known, so that harmonics of its turn mean something.
[[nodiscard]] MapChoice choose_map(const MapData& data, bool tied);

}  // namespace ripplenotch
