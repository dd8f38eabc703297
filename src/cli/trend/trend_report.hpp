// SPDX-License-Identifier: MIT
#pragma once
// What changed, for people: the alerts, joints unlike their kind, and what could not be looked at.

#include <string>

#include "ripplenotch/fleet/trend.hpp"

namespace ripplenotch {

[[nodiscard]] std::string trend_report(const Trend& trend);

}  // namespace ripplenotch
