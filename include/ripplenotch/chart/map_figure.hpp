// SPDX-License-Identifier: MIT
#pragma once
// A ripple map: amplitude and phase of each order over speed, by direction.

#include <string>

#include "ripplenotch/figure/figure.hpp"
#include "ripplenotch/filter/map_fit.hpp"

namespace ripplenotch {

/// Curves of what is the mean over the joint's turn, at the middle load; ribbons of 95 % by the errors of the
/// values at the speeds, taken as independent. Two panels, empty for an empty map.
[[nodiscard]] Figure map_figure(const std::string& source, const MapFit& fit);

}  // namespace ripplenotch
