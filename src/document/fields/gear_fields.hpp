// SPDX-License-Identifier: MIT
#pragma once
// The gear whose ripple a result is about, as every JSON has it.

#include <optional>

#include "document/json/json.hpp"
#include "ripplenotch/core/gear_account.hpp"

namespace ripplenotch {

/// {"ratio", "orders", "source"}; null when nobody says the gear.
[[nodiscard]] inline Json gear_to_json(const std::optional<GearAccount>& gear) {
    if (!gear) return nullptr;
    Json json = Json::object();
    json["ratio"] = gear->ratio.value();
    json["orders"] = Json::array();
    for (const Order order : gear->orders) list_in(json, "orders").push_back(order.value());
    json["source"] = gear->source;
    return json;
}

}  // namespace ripplenotch
