// SPDX-License-Identifier: MIT
#pragma once
// Changes in a fleet: joints by months, and the time series of those that changed.

#include "ripplenotch/figure/figure.hpp"
#include "ripplenotch/fleet/trend.hpp"

namespace ripplenotch {

/// A map of the first forty joints by month, and a panel for each of the first ten alerts.
[[nodiscard]] Figure trend_figure(const Trend& trend);

}  // namespace ripplenotch
