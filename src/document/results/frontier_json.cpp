// SPDX-License-Identifier: MIT
#include "ripplenotch/document/frontier_json.hpp"

#include <fmt/format.h>

#include "document/fields/document_head.hpp"
#include "document/fields/gear_fields.hpp"
#include "document/json/json.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

Json point_to_json(const TradePoint& point) {
    Json json = Json::object();
    json["bands"] = point.bands;
    json["attenuation_db"] = point.attenuation_db;
    json["delay_ms"] = 1e3 * point.delay.value();
    json["q"] = {point.least_q, point.largest_q};
    json["settle_ms"] = 1e3 * point.settle.value();
    json["overshoot_percent"] = point.overshoot_percent;
    return json;
}

}  // namespace

std::string frontier_to_json(const Frontier& frontier, const GearAccount& gear,
                             const Provenance& provenance) {
    const TableSpec& spec = frontier.spec;
    const DesignGoal& goal = frontier.goal;
    Json json = document_head("frontier", provenance);
    json["sample_rate_hz"] = spec.sample_rate.value();
    json["gear_ratio"] = spec.gear_ratio.value();
    json["gear"] = gear_to_json(gear);
    json["gear_ratio_error_percent"] = 100.0 * spec.ratio_error;
    json["orders"] = Json::array();
    for (const Order order : spec.orders) list_in(json, "orders").push_back(order.value());
    json["amplitude_nm"] = spec.amplitude_nm.empty() ? Json(nullptr) : Json(spec.amplitude_nm);
    json["speed_deg_s"] = {goal.from.value(), goal.to.value()};
    json["settle_band_percent"] = spec.settle_band_percent;
    json["min_attenuation_db"] = goal.min_attenuation_db ? Json(*goal.min_attenuation_db) : Json(nullptr);
    json["max_delay_ms"] = goal.max_delay ? Json(1e3 * goal.max_delay->value()) : Json(nullptr);
    json["max_bands"] = goal.most_bands ? Json(*goal.most_bands) : Json(nullptr);
    json["points"] = Json::array();
    for (const TradePoint& point : frontier.points) list_in(json, "points").push_back(point_to_json(point));
    json["recommended"] = point_to_json(frontier.points[frontier.recommended]);
    object_in(json, "recommended")["point"] = frontier.recommended;
    object_in(json, "recommended")["reason"] = frontier.reason;
    object_in(json, "recommended")["no_notch_below_deg_s"] =
        frontier.slowest ? Json(frontier.slowest->value()) : Json(nullptr);
    return to_fitted_text(std::move(json));
}

std::string frontier_to_csv(const Frontier& frontier) {
    std::string csv =
        "bands,attenuation_db,delay_ms,q_least,q_largest,settle_ms,overshoot_percent,recommended\n";
    for (std::size_t i = 0; i < frontier.points.size(); ++i) {
        const TradePoint& point = frontier.points[i];
        csv += fmt::format("{},{:.2f},{:.3f},{},{},{:.3f},{:.3f},{}\n", point.bands, point.attenuation_db,
                           1e3 * point.delay.value(), shortest(point.least_q), shortest(point.largest_q),
                           1e3 * point.settle.value(), point.overshoot_percent,
                           i == frontier.recommended ? 1 : 0);
    }
    return csv;
}

}  // namespace ripplenotch
