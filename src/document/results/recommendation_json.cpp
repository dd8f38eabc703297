// SPDX-License-Identifier: MIT
#include "ripplenotch/document/recommendation_json.hpp"

#include "document/fields/document_head.hpp"
#include "document/fields/gear_fields.hpp"
#include "document/fields/ripple_fields.hpp"
#include "document/json/json.hpp"

namespace ripplenotch {
namespace {

Json orders_to_json(const std::vector<RippleEstimate>& orders) {
    Json json = Json::array();
    for (const RippleEstimate& one : orders) json.push_back(ripple_to_json(one));
    return json;
}

Json judged_method_to_json(const JudgedMethod& method) {
    Json json;
    json["method"] = method.figures.method;
    json["meets"] = method.meets();
    json["error_nm"] = method.error_nm;
    json["ripple_rms_nm"] = or_null(method.figures.ripple_rms_nm);
    json["longest_delay_ms"] = 1e3 * method.delay.value();
    json["longest_delay_at_deg_s"] = method.delay_at.value();
    json["dc_delay_ms"] = or_null(method.figures.dc_delay_ms);
    json["attenuation_db"] = Json::array();
    for (const OrderAttenuation& entry : method.figures.attenuation)
        json["attenuation_db"].push_back({{"order", entry.order}, {"db", or_null(entry.db)}});
    json["shortfalls"] = method.shortfalls;
    return json;
}

}  // namespace

std::string recommendation_text(const RecommendationReport& report, const Provenance& provenance) {
    const Recommendation& found = report.found;
    Json json = document_head("recommendation", provenance);
    json["verdict"] = recommendation_verdict(found);
    json["finding"] = recommendation_finding_name(found.finding);
    json["conclusive"] = report.conclusive;
    json["max_delay_ms"] =
        found.limits.max_delay ? Json(1e3 * found.limits.max_delay->value()) : Json(nullptr);
    json["min_attenuation_db"] = or_null(found.limits.min_attenuation_db);
    json["target"] = report.target.empty() ? Json(nullptr) : Json(report.target);
    json["gear"] = gear_to_json(report.gear);
    json["split_s"] = report.split_s;
    json["windows"] = found.windows;
    json["torque_rate_nm_s"] = found.torque_rate_nm_s;
    json["orders"] = orders_to_json(found.orders);
    const JudgedMethod* const next = found.runner_up();
    json["take"] = found.finding == RecommendationFinding::recommended ? Json(found.taken()->figures.method)
                                                                       : Json(nullptr);
    json["take_commands"] = report.take;
    json["runner_up"] = next != nullptr ? Json(next->figures.method) : Json(nullptr);
    json["runner_up_commands"] = report.runner_up;
    json["check"] = report.check;
    json["methods"] = Json::array();
    for (const JudgedMethod& method : found.methods) json["methods"].push_back(judged_method_to_json(method));
    json["assumed"] = report.assumed;
    json["left_out"] = report.left_out;
    return to_fitted_text(std::move(json));
}

}  // namespace ripplenotch
