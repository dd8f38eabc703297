// SPDX-License-Identifier: MIT
#pragma once
// A ripple map of logs that tell the joint's temperature.

#include <span>
#include <vector>

#include "ripplenotch/filter/map_fit.hpp"

namespace ripplenotch {

/// fit_ripple_map with the joint's temperature in degC at each row of each log, which enters where it pays.
/// The same as without where `temperatures_degc` is empty.
[[nodiscard]] MapFit fit_warm_ripple_map(std::span<const TraceView> logs, const GearAccount& gear,
                                         double zero_deg,
                                         std::span<const std::vector<double>> temperatures_degc);

}  // namespace ripplenotch
