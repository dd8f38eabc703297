// SPDX-License-Identifier: MIT
#include "ripplenotch/document/identification_json.hpp"

#include <array>
#include <utility>

#include "document/fields/document_head.hpp"
#include "document/fields/gear_fields.hpp"
#include "document/json/json.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

Json optional_to_json(const std::optional<double>& value) {
    return value ? finite_or_null(*value) : Json(nullptr);
}

Json line_to_json(const Line& line) {
    Json json = Json::object();
    json["kind"] = line_kind_name(line.kind);
    json["order"] = optional_to_json(line.order);
    json["order_output"] = optional_to_json(line.order_output);
    json["order_output_stderr"] = optional_to_json(line.order_output_stderr);
    json["could_be"] = line.could_be;
    json["hz"] = optional_to_json(line.hz);
    json["amplitude_nm"] = line.amplitude_nm;
    json["phase_deg"] = line.phase_known ? finite_or_null(line.phase_deg) : Json(nullptr);
    json["snr"] = line.snr;
    json["speed_range_deg_s"] = {line.speed_from_deg_s, line.speed_to_deg_s};
    json["amplitude_by_speed"] = Json::array();
    for (const AmplitudeAtSpeed& at : line.by_speed) {
        list_in(json, "amplitude_by_speed")
            .push_back({{"speed_deg_s", at.speed_deg_s},
                        {"hz", at.hz},
                        {"amplitude_nm", at.amplitude_nm},
                        {"snr", at.snr}});
    }
    json["note"] = line.note;
    return json;
}

Json ratio_to_json(const GearRatioFit& fit) {
    Json json = Json::object();
    json["value"] = optional_to_json(fit.value);
    json["stderr"] = fit.value ? finite_or_null(fit.standard_error) : Json(nullptr);
    json["ci95"] =
        fit.value ? Json{finite_or_null(fit.ci95_low), finite_or_null(fit.ci95_high)} : Json(nullptr);
    json["second_comb"] = optional_to_json(fit.second_comb);
    json["candidates"] = Json::array();
    for (const RatioCandidate& candidate : fit.candidates) {
        list_in(json, "candidates")
            .push_back({{"value", candidate.value},
                        {"score", candidate.score},
                        {"reason", candidate.reason},
                        {"other_unit", candidate.other_unit}});
    }
    json["residuals"] = Json::array();
    for (const auto& r : fit.residuals) {
        // As many decimals as the frequency has: below them is only how a processor rounds.
        list_in(json, "residuals")
            .push_back({{"speed_deg_s", r.speed_deg_s},
                        {"hz", r.hz},
                        {"order", r.order},
                        {"residual_hz", to_digits_in_row({.value = r.residual_hz, .largest = r.hz})},
                        {"weight", r.weight}});
    }
    return json;
}

Json velocity_error_to_json(const std::optional<VelocityError>& error) {
    if (!error) return nullptr;
    Json json = {{"offset_deg_s", to_digits_in_row({.value = error->offset.value(),
                                                    .largest = 10.0 * error->offset_error.value()})},
                 {"offset_stderr_deg_s", error->offset_error.value()},
                 {"delay_s", nullptr},
                 {"delay_stderr_s", nullptr}};
    if (!error->delay_told) return json;
    json["delay_s"] =
        to_digits_in_row({.value = error->delay.value(), .largest = 10.0 * error->delay_error.value()});
    json["delay_stderr_s"] = to_digits(error->delay_error.value());
    return json;
}

void add_besides(Json& json, const Identification& identification) {
    json["velocity_error"] = velocity_error_to_json(identification.velocity_error);
    json["families"] = Json::array();
    for (const ToneFamily& family : identification.families) {
        list_in(json, "families")
            .push_back({{"hz", family.hz}, {"hz_stderr", family.hz_stderr}, {"multiples", family.multiples}});
    }
    json["hums"] = Json::array();
    for (const Hum& hum : identification.hums) {
        list_in(json, "hums")
            .push_back({{"from_hz", hum.from_hz},
                        {"to_hz", hum.to_hz},
                        {"peak_hz", hum.peak_hz},
                        {"rms_nm", hum.rms_nm}});
    }
    json["disagreements"] = Json::array();
    for (const Disagreement& one : identification.disagreements) {
        Json entry = Json::object();
        entry["about"] = about_name(one.about);
        entry["order"] = optional_to_json(one.order);
        entry["order_output"] = optional_to_json(one.order_output);
        entry["chance"] = one.chance;
        entry["values"] = Json::array();
        for (const Disagreement::Value& value : one.values) {
            list_in(entry, "values")
                .push_back({{"recording", value.recording}, {"value", value.value}, {"stderr", value.error}});
        }
        list_in(json, "disagreements").push_back(std::move(entry));
    }
}

void add_fields(Json& json, const Identification& identification) {
    json["verdict"] = identification.verdict;
    json["finding"] = finding_name(identification.finding);
    json["doubts"] = Json::array();
    for (const Doubt& doubt : identification.doubts)
        list_in(json, "doubts").push_back({{"reason", doubt_name(doubt.reason)}, {"because", doubt.because}});
    json["conclusive"] = identification.conclusive;
    json["joint"] = identification.joint;
    json["sample_rate_hz"] = identification.sample_rate.value();
    json["evidence"] = identification.evidence;
    json["searched"] = nullptr;
    if (const auto& searched = identification.searched) {
        json["searched"] = {{"lowest_order", searched->lowest_order},
                            {"highest_order", searched->highest_order},
                            {"detectable_nm", searched->detectable_nm},
                            {"bounds", Json::array()}};
        for (const SearchedOrders::Bound& bound : searched->bounds)
            list_in(json["searched"], "bounds")
                .push_back({{"from_order", bound.from_order}, {"detectable_nm", bound.detectable_nm}});
    }
    json["gear_ratio"] = ratio_to_json(identification.gear_ratio);
    json["gear"] = gear_to_json(found_gear(identification));
    json["lines"] = Json::array();
    for (const Line& line : identification.lines) list_in(json, "lines").push_back(line_to_json(line));
    add_besides(json, identification);
    json["notes"] = identification.notes;
}

}  // namespace

std::string identification_text(const Identification& identification, const Provenance& provenance) {
    Json json = document_head("joint", provenance);
    add_fields(json, identification);
    return to_fitted_text(std::move(json));
}

std::string identifications_text(std::span<const Identification> identifications,
                                 const Provenance& provenance) {
    Json json = document_head("joints", provenance);
    json["joints"] = Json::array();
    for (const Identification& identification : identifications) {
        Json entry = Json::object();
        add_fields(entry, identification);
        list_in(json, "joints").push_back(std::move(entry));
    }
    return to_fitted_text(std::move(json));
}

}  // namespace ripplenotch
