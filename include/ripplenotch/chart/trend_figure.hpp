// SPDX-License-Identifier: MIT
#pragma once
// Changes in a fleet: the time series of the joints that changed.

#include "ripplenotch/figure/figure.hpp"
#include "ripplenotch/fleet/trend.hpp"

namespace ripplenotch {

/// A panel for each of the first ten alerts.
[[nodiscard]] Figure trend_figure(const Trend& trend);

}  // namespace ripplenotch
