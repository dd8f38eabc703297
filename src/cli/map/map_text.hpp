// SPDX-License-Identifier: MIT
#pragma once
// A ripple map as people read it.

#include <string>
#include <vector>

#include "ripplenotch/filter/map_fit.hpp"

namespace ripplenotch {

/// Verdict, what is left of each order on blocks left out, the amplitudes with their 95 % intervals, and what
/// the logs say against each other. `logs` are their names.
[[nodiscard]] std::string map_report(const MapFit& fit, const std::vector<std::string>& logs);

}  // namespace ripplenotch
