// SPDX-License-Identifier: MIT
#pragma once
// A spectrum over speed as JSON.

#include <optional>
#include <string>

#include "ripplenotch/analysis/order_map.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/document/provenance.hpp"

namespace ripplenotch {

/// Schema ripplenotch/spectrum/1 with `domain` campbell or order-map. `axis_name` is what the axis counts:
/// frequency_hz, order or order_output.
[[nodiscard]] std::string speed_map_text(const std::string& joint, const SpeedMap& map,
                                         std::string_view axis_name, const std::optional<GearAccount>& gear,
                                         const Provenance& provenance);

}  // namespace ripplenotch
