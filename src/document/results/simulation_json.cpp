// SPDX-License-Identifier: MIT
#include "ripplenotch/document/simulation_json.hpp"
#include "document/fields/fields.hpp"
#include "document/fields/result_fields.hpp"
#include "document/json/json.hpp"
#include "ripplenotch/core/number.hpp"

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

namespace {

std::string_view left_out_name(LeftOut left_out) {
    switch (left_out) {
        case LeftOut::fitted:
            return "fitted";
        case LeftOut::refused:
            return "refused";
        default:
            return "assumed";
    }
}

Json parameter_json(const Parameter& parameter) {
    return {{"name", parameter.name},       {"unit", parameter.unit},
            {"neutral", parameter.neutral}, {"first_guess", parameter.start},
            {"lower", parameter.lower},     {"upper", parameter.upper},
            {"linear", parameter.linear},   {"left_out", left_out_name(parameter.left_out)},
            {"meaning", parameter.help}};
}

Json effect_json(const Effect& effect) {
    Json json = {{"effect", effect.name},        {"side", side_name(effect.side)},
                 {"summary", effect.summary},    {"equation", effect.equation},
                 {"parameters", Json::array()},  {"symptom", effect.symptom},
                 {"look_alikes", Json::array()}, {"source", effect.source}};
    for (const Parameter& parameter : effect.parameters)
        list_in(json, "parameters").push_back(parameter_json(parameter));
    for (const LookAlike& other : effect.look_alikes) {
        list_in(json, "look_alikes")
            .push_back({{"name", other.name}, {"when", other.when}, {"told_by", other.told_by}});
    }
    return json;
}

}  // namespace

std::string write_catalogue(std::span<const Effect* const> effects, const Provenance& provenance) {
    Json json = document_head("effects", provenance);
    json["effects"] = Json::array();
    for (const Effect* effect : effects) list_in(json, "effects").push_back(effect_json(*effect));
    return to_text(json);
}

std::string write_simulation(const Simulation& simulation, const Provenance& provenance) {
    Json json = document_head("simulation", provenance);
    json["rows"] = simulation.rows;
    json["sample_rate_hz"] = simulation.sample_rate.value();
    json["duration_s"] = static_cast<double>(simulation.rows) / simulation.sample_rate.value();
    json["columns"] = simulation.columns;
    json["motions"] = simulation.motions;
    json["seed"] = simulation.seed;
    if (const auto& followed = simulation.followed) {
        json["along_log"] = {{"smoothing_s", followed->smoothing.value()},
                             {"measured_rms_nm", followed->measured_rms_nm},
                             {"residual_rms_nm", to_digits(followed->residual_rms_nm)}};
    }
    json["noise_rms_nm"] = simulation.noise_rms.value();
    json["noise_correlation"] = simulation.noise_correlation;
    json["velocity_noise_rms_deg_s"] = simulation.velocity_noise_rms.value();
    json["torque_nm"] = {{"min", simulation.torque_min_nm}, {"max", simulation.torque_max_nm}};
    json["speed_deg_s"] = {{"min", simulation.speed_min_deg_s}, {"max", simulation.speed_max_deg_s}};
    json["gear"] = gear_to_json(simulation.gear);
    json["model"] = Json::object();
    put_model(json["model"], simulation.model);
    json["output"] = {{"name", simulation.output}, {"sha256", simulation.output_sha256}};
    return to_text(json);
}

}  // namespace ripplenotch
