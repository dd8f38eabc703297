// SPDX-License-Identifier: MIT
#pragma once
// Parts of a diagnosis as fields: what a term was fitted to, and where something is.

#include <vector>

#include "document/json/json.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {

/// {"level_nm": {"value", "ci95", "fitted", "at_bound"}, ...}, one entry a parameter of the term's effect.
[[nodiscard]] Json parameters_json(const Term& term, const std::vector<FittedValue>& values);

/// {"time_s", "speed_deg_s", "position_deg", "hz", "order", "direction"}
[[nodiscard]] Json place_json(const Place& place);

}  // namespace ripplenotch
