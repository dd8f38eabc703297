// SPDX-License-Identifier: MIT
#include "ripplenotch/document/export_json.hpp"

#include "document/fields/document_head.hpp"
#include "document/json/json.hpp"

namespace ripplenotch {
namespace {

Json number_or_null(const std::optional<double>& value) {
    return value ? finite_or_null(*value) : Json(nullptr);
}

Json check_to_json(const SectionCheck& check) {
    Json json = Json::object();
    json["band"] = check.band;
    json["speed_from_deg_s"] = check.from.value();
    json["speed_to_deg_s"] = check.to.value();
    json["section"] = check.section;
    json["order"] = check.order ? Json(check.order->value()) : Json(nullptr);
    json["center_hz"] = check.center.value();
    json["center_shift_percent"] = number_or_null(check.shift_percent);
    json["q"] = finite_or_null(check.q);
    json["response_depth_db"] = check.is_notch ? finite_or_null(check.response_depth_db) : Json(nullptr);
    json["depth_db"] = number_or_null(check.depth_db);
    json["dc_error_db"] = number_or_null(check.dc_error_db);
    json["mean_error_nm"] = number_or_null(check.mean_error_nm);
    json["pole_radius"] = finite_or_null(check.pole_radius);
    return json;
}

}  // namespace

std::string export_report_to_json(const ExportReport& report, const Provenance& provenance) {
    Json json = document_head("export", provenance);
    json["target"] = report.target;
    json["file"] = report.file;
    json["bytes"] = report.bytes;
    json["sample_rate_hz"] = report.sample_rate.value();
    json["bands"] = report.bands;
    json["sections_per_band"] = report.sections_per_band;
    json["usage"] = report.usage;
    json["warnings"] = report.warnings;
    json["verified"] = report.verified;
    json["arithmetic"] = report.verified ? Json(report.arithmetic) : Json(nullptr);
    json["sections"] = Json::array();
    for (const SectionCheck& check : report.checks) list_in(json, "sections").push_back(check_to_json(check));
    json["violations"] = report.violations;
    return to_fitted_text(std::move(json));
}

}  // namespace ripplenotch
