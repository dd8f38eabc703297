// SPDX-License-Identifier: MIT
#pragma once
// The trade-off curve of design --frontier, as JSON and CSV.

#include <string>

#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/design/frontier.hpp"
#include "ripplenotch/document/provenance.hpp"

namespace ripplenotch {

/// The whole text, schema ripplenotch/frontier/1; same frontier, same bytes.
[[nodiscard]] std::string frontier_to_json(const Frontier& frontier, const GearAccount& gear,
                                           const Provenance& provenance);

/// bands, attenuation_db, delay_ms, q_least, q_largest, settle_ms, overshoot_percent, recommended (0 or 1).
[[nodiscard]] std::string frontier_to_csv(const Frontier& frontier);

}  // namespace ripplenotch
