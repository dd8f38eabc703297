// SPDX-License-Identifier: MIT
#include "ripplenotch/document/diagnosis_json.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "document/fields/angle_fields.hpp"
#include "document/fields/beside_fields.hpp"
#include "document/fields/decided_fields.hpp"
#include "document/fields/diagnosis_fields.hpp"
#include "document/fields/document_head.hpp"
#include "document/fields/gear_fields.hpp"
#include "document/fields/model_fields.hpp"
#include "document/fields/written_fields.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

// A frequency is known to more digits than that.
Json ten(double value) { return finite_or_null(to_digits(value, 10) + 0.0); }

Json spans_json(const std::vector<Span>& spans) {
    Json list = Json::array();
    for (const Span& span : spans) list.push_back({six_digits(span.from), six_digits(span.to)});
    return list;
}

Json numbers_json(const std::vector<double>& values) {
    Json list = Json::array();
    for (const double value : values) list.push_back(six_digits(value));
    return list;
}

}  // namespace

Json place_json(const Place& place) {
    return {{"time_s", spans_json(place.time_s)},
            {"speed_deg_s", spans_json(place.speed_deg_s)},
            {"position_deg", spans_json(place.position_deg)},
            {"hz", numbers_json(place.hz)},
            {"order", numbers_json(place.order)},
            {"direction", place.direction == Direction::at_rest_too ? Json(nullptr)
                                                                    : Json(direction_name(place.direction))}};
}

Json parameters_json(const Term& term, const std::vector<FittedValue>& values) {
    Json parameters = Json::object();
    for (std::size_t p = 0; p < term.values.size(); ++p) {
        const Parameter& parameter = term.effect->parameters[p];
        Json entry{{"value", ten(term.values[p].value_or(parameter.start))}, {"ci95", nullptr}};
        const auto fitted = std::find_if(values.begin(), values.end(),
                                         [&](const FittedValue& value) { return value.parameter == p; });
        if (fitted != values.end() && fitted->ci95)
            entry["ci95"] = {ten(fitted->ci95->low), ten(fitted->ci95->high)};
        if (fitted == values.end()) entry["fitted"] = false;
        if (fitted != values.end() && fitted->at_bound) entry["at_bound"] = true;
        parameters[std::string(parameter.name)] = entry;
    }
    return parameters;
}

namespace {

Json round_json(const Finding& finding) {
    const Term& term = finding.term;
    Json json{{"effect", term.effect->name}, {"status", status_name(finding.status)}};
    if (!finding.reason.empty()) json["reason"] = finding.reason;
    json["parameters"] = parameters_json(term, finding.values);
    json["where"] = place_json(finding.where);
    json["evidence"] = {{"gain", six_digits(finding.evidence.gain)},
                        {"price", six_digits(finding.evidence.price)},
                        {"share_nm", six_digits(finding.evidence.share_nm)},
                        {"share_of_noise", six_digits(finding.evidence.share_sigma)},
                        {"own_nm", six_digits(finding.evidence.own_nm)},
                        {"gain_elsewhere", six_digits(finding.evidence.elsewhere)},
                        {"t", six_digits(finding.evidence.t)},
                        {"blocks", finding.evidence.blocks},
                        {"blocks_positive", finding.evidence.blocks_positive}};
    json["alternatives"] = Json::array();
    for (const RivalFinding& rival : finding.alternatives)
        list_in(json, "alternatives")
            .push_back({{"effect", rival.effect}, {"margin", six_digits(rival.margin)}});
    json["validation_before_nm"] = six_digits(finding.validation_before_nm);
    json["validation_after_nm"] = six_digits(finding.validation_after_nm);
    json["gap_before_nm"] = six_digits(finding.gap_before_nm);
    json["gap_after_nm"] = six_digits(finding.gap_after_nm);
    return json;
}

Json fault_json(const Fault& fault) {
    return {{"effect", fault.term.effect->name},
            {"parameters", parameters_json(fault.term, {})},
            {"samples", fault.samples},
            {"time_s", spans_json(fault.time_s)},
            {"words", fault.words}};
}

Json regions_json(const std::vector<ResidualRegion>& residual_regions) {
    Json list = Json::array();
    for (const ResidualRegion& region : residual_regions) {
        list.push_back({{"kind", region_kind_name(region.kind)},
                        {"where", place_json(region.where)},
                        {"rms_nm", six_digits(region.rms_nm)},
                        {"part_of_gap", six_digits(region.part)}});
    }
    return list;
}

Json gap_json(const DiagnosisGap& gap) {
    return {{"before_nm", six_digits(gap.before_nm)},
            {"after_nm", six_digits(gap.after_nm)},
            {"noise_floor_nm", six_digits(gap.noise_floor_nm)},
            {"closed_percent", six_digits(gap.closed_percent)},
            {"validation_before_nm", six_digits(gap.validation_before_nm)},
            {"validation_after_nm", six_digits(gap.validation_after_nm)},
            {"validation_closed_percent", six_digits(gap.validation_closed_percent)}};
}

Json baseline_json(const Diagnosis& diagnosis) {
    Json list = Json::array();
    for (std::size_t term = 0; term < diagnosis.baseline.terms.size(); ++term) {
        std::vector<FittedValue> values;
        for (const FittedValue& value : diagnosis.values) {
            if (value.term == term) values.push_back(value);
        }
        list.push_back({{"effect", diagnosis.baseline.terms[term].effect->name},
                        {"parameters", parameters_json(diagnosis.model.terms[term], values)}});
    }
    return list;
}

Json decision_json(std::string_view effect, const Json& round, std::string_view outcome,
                   const std::vector<Decision>& decisions) {
    Json rules = Json::array();
    for (const Decision& decision : decisions) {
        rules.push_back({{"rule", decision.rule},
                         {"number", six_digits(decision.number)},
                         {"limit", six_digits(decision.limit)},
                         {"unit", decision.unit},
                         {"against", decision.against}});
    }
    return {{"effect", effect}, {"round", round}, {"outcome", outcome}, {"rules", rules}};
}

Json arm_json(const ArmAccount& arm) {
    Json json{{"source", arm.source}, {"matched", arm.rule}, {"option", arm.option}};
    json["joints"] = Json::array();
    for (const JointTravel& joint : arm.joints)
        list_in(json, "joints")
            .push_back(
                {{"name", joint.name}, {"log", joint.log}, {"travel_deg", six_digits(joint.travel_deg)}});
    json["lengths_are_guessed"] = arm.lengths_are_guessed;
    json["smoothing_s"] = arm.smoothing.value();
    json["gap_before_nm"] = six_digits(arm.gap_before_nm);
    if (arm.values_are_stated) {
        json["values_are_stated"] = true;
        return json;
    }
    json["values_there"] = arm.values_there;
    json["values_told"] = arm.values_told;
    json["all_joints_at_once"] = arm.all_joints_at_once;
    json["lambda"] = arm.pull;
    json["gap_nm"] = six_digits(arm.gap_nm);
    if (arm.lag) {
        json["lag"] = {
            {"delay_s", six_digits(arm.lag->delay_s)},
            {"ci95_s", {six_digits(arm.lag->delay_95_s.low), six_digits(arm.lag->delay_95_s.high)}},
            {"applied", arm.lag_is_applied},
            {"joints", Json::array()}};
        for (const JointLag& joint : arm.lag->joints)
            list_in(json["lag"], "joints")
                .push_back({{"name", arm.joints.at(joint.joint).name},
                            {"delay_s", six_digits(joint.delay_s)},
                            {"contradicts", joint.contradicts}});
    }
    return json;
}

// Which rules were asked about each finding and each candidate of the last step.
Json decisions_json(const Diagnosis& diagnosis) {
    Json list = Json::array();
    for (std::size_t i = 0; i < diagnosis.rounds.size(); ++i) {
        const Finding& finding = diagnosis.rounds[i];
        list.push_back(
            decision_json(finding.term.effect->name, i + 1, status_name(finding.status), finding.decisions));
    }
    for (const RefusedCandidate& candidate : diagnosis.refused)
        list.push_back(decision_json(candidate.term.effect->name, nullptr, "refused", candidate.decisions));
    return list;
}

void put_diagnosis(Json& json, const Diagnosis& diagnosis, const GearAccount& gear, const ArmAccount* arm,
                   const DiagnosisWritten& written) {
    json["verdict"] = verdict_name(diagnosis.verdict);
    if (!diagnosis.doubt.empty()) json["doubt"] = diagnosis.doubt;
    json["gear"] = gear_to_json(gear);
    json["named"] = diagnosis.named;
    json["wrong_percent"] = six_digits(wrong_percent(diagnosis));
    json["rounds"] = Json::array();
    for (const Finding& finding : diagnosis.rounds) list_in(json, "rounds").push_back(round_json(finding));
    json["decisions"] = decisions_json(diagnosis);
    json["faults"] = Json::array();
    for (const Fault& fault : diagnosis.faults) list_in(json, "faults").push_back(fault_json(fault));
    json["ambiguous"] = Json::array();
    for (const Tie& tie : diagnosis.ambiguous)
        list_in(json, "ambiguous").push_back({{"effects", tie.effects}, {"advice", tie.advice}});
    json["unexplained"] = regions_json(diagnosis.unexplained);
    json["disagreement"] = regions_json(diagnosis.disagreement);
    json["undecidable"] = Json::array();
    for (const Undecidable& entry : diagnosis.undecidable)
        list_in(json, "undecidable")
            .push_back({{"effect", entry.effect},
                        {"reason", entry.reason},
                        {"would_explain_nm", six_digits(entry.would_explain_nm)}});
    json["gap"] = gap_json(diagnosis.gap);
    put_beside(json, diagnosis);
    put_decided(json, diagnosis);
    if (arm != nullptr) json["arm"] = arm_json(*arm);
    put_written(json, written);
    json["own_terms"] = baseline_json(diagnosis);
    json["samples"] = diagnosis.samples;
    json["samples_used"] = diagnosis.samples_used;
    json["samples_not_used"] = Json::array();
    for (const UnusedRows& rows : diagnosis.unused)
        list_in(json, "samples_not_used").push_back({{"reason", rows.reason}, {"samples", rows.rows}});
    json["acts_where_not_used"] = Json::array();
    for (const EffectOfUnusedRows& one : diagnosis.acts_where_unused)
        list_in(json, "acts_where_not_used")
            .push_back({{"effect", one.effect}, {"samples", one.rows}, {"not_used", one.unused}});
    json["position_in_log"] = diagnosis.has_position;
    put_angle(json, diagnosis);
    json["search"] = {{"evaluations", std::round(diagnosis.evaluations)}, {"ended", diagnosis.search_ended}};
    json["noise_color"] = numbers_json(diagnosis.noise_color);
    json["false_alarm"] = diagnosis.false_alarm;
    json["model"] = {{"schema", "ripplenotch/model/1"}};
    put_model(json["model"], diagnosis.model);
}

}  // namespace

std::string write_diagnosis(const Diagnosis& diagnosis, const GearAccount& gear, const Provenance& provenance,
                            const ArmAccount* arm, const DiagnosisWritten& written) {
    Json json = document_head("diagnosis", provenance);
    put_diagnosis(json, diagnosis, gear, arm, written);
    return to_fitted_text(std::move(json));
}

std::string write_diagnoses(std::span<const DiagnosedJoint> joints, const Provenance& provenance) {
    Json json = document_head("diagnoses", provenance);
    json["joints"] = Json::array();
    for (const DiagnosedJoint& one : joints) {
        Json entry{{"joint", one.joint}};
        put_diagnosis(entry, one.diagnosis, one.gear, one.arm, one.written);
        list_in(json, "joints").push_back(std::move(entry));
    }
    return to_fitted_text(std::move(json));
}

}  // namespace ripplenotch
