// SPDX-License-Identifier: MIT
#pragma once
// Which orders are ripple, and the form of their map: by blocks of windows that are left out of the fit.

#include "filter/map/map_data.hpp"
#include "ripplenotch/filter/map_fit.hpp"

namespace ripplenotch {

/// Finding, scores, notes and the map's form, of data that have a window. Where `fit` is not anchored the
/// joint's own angle is not known, and a second comb means nothing.
void choose_map(const MapData& data, MapFit& fit);

}  // namespace ripplenotch
