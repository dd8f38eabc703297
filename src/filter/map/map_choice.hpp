// SPDX-License-Identifier: MIT
#pragma once
// Which orders are ripple, and the form of their map: by blocks of windows that are left out of the fit.

#include <string>
#include <vector>

#include "filter/map/map_data.hpp"
#include "ripplenotch/filter/map_fit.hpp"

namespace ripplenotch {

struct MapChoice {
    MapForm form;
    std::vector<MapOrderScore> scores;  ///< by order of the data
    MapFinding finding = MapFinding::nothing;
    std::vector<std::string> notes;
};

/// `tied` states whether the joint's own angle is known, so that the second comb means something. The data
/// have a window.
[[nodiscard]] MapChoice choose_map(const MapData& data, bool tied);

}  // namespace ripplenotch
