// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "document/fields/fields.hpp"
#include "document/fields/result_fields.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/document/diagnosis_json.hpp"

namespace ripplenotch {

namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

// A number that is not there is null.
double number_or_unknown(Fields& fields, std::string_view name) {
    return fields.number_if_any(name).value_or(unknown);
}

// The enumerator of this name, of those from the first to `last`.
template <class Enum>
Enum enumerator_of(Fields& fields, std::string_view name, Enum last, std::string_view (*name_of)(Enum)) {
    return fields.named(name, [&](const std::string& text) -> std::optional<Enum> {
        for (int i = 0; i <= static_cast<int>(last); ++i)
            if (name_of(static_cast<Enum>(i)) == text) return static_cast<Enum>(i);
        return std::nullopt;
    });
}

Span span_of(const Json& json, const std::string& where) {
    if (!json.is_array() || json.size() != 2 || !json[0].is_number() || !json[1].is_number())
        raise<DataError>("{} holds {}, expected two numbers", where, in_words(json));
    return {json[0].get<double>(), json[1].get<double>()};
}

std::vector<Span> spans_of(Fields& fields, std::string_view name) {
    std::vector<Span> spans;
    for (const Json& entry : fields.list(name)) spans.push_back(span_of(entry, fields.where(name)));
    return spans;
}

Place place_of(Fields& fields, std::string_view name) {
    Fields where = fields.object(name);
    Place place{spans_of(where, "time_s"), spans_of(where, "speed_deg_s"), spans_of(where, "position_deg"),
                where.numbers("hz"), where.numbers("order")};
    if (where.has("direction"))
        place.direction = enumerator_of(where, "direction", Direction::both, direction_name);
    where.finish();
    return place;
}

// Values of the parameters; those that were fitted are added to `fitted` as of this place in the model.
Term fitted_term_of(Fields& fields, std::size_t place, std::vector<FittedValue>& fitted) {
    Term term{&effect_of(fields), {}};
    Fields parameters = fields.object("parameters");
    for (const Parameter& parameter : term.effect->parameters) {
        Fields entry = parameters.object(parameter.name);
        term.values.push_back(entry.number_if_any("value"));
        FittedValue value;
        value.term = place;
        value.parameter = term.values.size() - 1;
        value.value = term.values.back().value_or(unknown);
        if (const Json* ci95 = entry.find("ci95")) {
            const Span interval = span_of(*ci95, entry.where("ci95"));
            value.ci95 = Interval{interval.from, interval.to};
        }
        value.at_bound = entry.has("at_bound") && entry.flag("at_bound");
        if (!entry.has("fitted") || entry.flag("fitted")) fitted.push_back(value);
        entry.finish();
    }
    parameters.finish();
    return term;
}

void read_evidence(Fields& fields, Finding& finding) {
    Fields entry = fields.object("evidence");
    finding.evidence = {.gain = number_or_unknown(entry, "gain"),
                        .price = number_or_unknown(entry, "price"),
                        .share_nm = number_or_unknown(entry, "share_nm"),
                        .share_sigma = number_or_unknown(entry, "share_of_noise"),
                        .own_nm = number_or_unknown(entry, "own_nm"),
                        .raw_gain = unknown,
                        .elsewhere = number_or_unknown(entry, "gain_elsewhere")};
    finding.evidence.t = entry.number_if_any("t").value_or(0.0);
    if (entry.has("blocks")) {
        finding.evidence.blocks = entry.whole("blocks");
        finding.evidence.blocks_positive = entry.whole("blocks_positive");
    }
    entry.finish();
}

Finding finding_at(Fields& fields, std::size_t place) {
    Finding finding;
    finding.term = fitted_term_of(fields, place, finding.values);
    finding.status = enumerator_of(fields, "status", FindingStatus::not_reproduced, status_name);
    if (fields.has("reason")) finding.reason = fields.text("reason");
    finding.where = place_of(fields, "where");
    read_evidence(fields, finding);
    fields.each("alternatives", [&](Fields& rival) {
        finding.alternatives.push_back({effect_of(rival).name, number_or_unknown(rival, "margin")});
    });
    finding.validation_before_nm = fields.number_if_any("validation_before_nm");
    finding.validation_after_nm = fields.number_if_any("validation_after_nm");
    finding.gap_before_nm = number_or_unknown(fields, "gap_before_nm");
    finding.gap_after_nm = number_or_unknown(fields, "gap_after_nm");
    return finding;
}

std::vector<ResidualRegion> regions_of(Fields& fields, std::string_view name) {
    std::vector<ResidualRegion> residual_regions;
    fields.each(name, [&](Fields& entry) {
        residual_regions.push_back({enumerator_of(entry, "kind", RegionKind::speed, region_kind_name),
                                    place_of(entry, "where"), number_or_unknown(entry, "rms_nm"),
                                    number_or_unknown(entry, "part_of_gap")});
    });
    return residual_regions;
}

DiagnosisGap gap_of(Fields& fields) {
    Fields entry = fields.object("gap");
    DiagnosisGap gap{
        number_or_unknown(entry, "before_nm"),           number_or_unknown(entry, "after_nm"),
        number_or_unknown(entry, "noise_floor_nm"),      entry.number_if_any("closed_percent"),
        entry.number_if_any("validation_before_nm"),     entry.number_if_any("validation_after_nm"),
        entry.number_if_any("validation_closed_percent")};
    entry.finish();
    return gap;
}

std::vector<Decision> rules_of(Fields& fields) {
    std::vector<Decision> decisions;
    fields.each("rules", [&](Fields& entry) {
        decisions.push_back({entry.text("rule"), number_or_unknown(entry, "number"),
                             number_or_unknown(entry, "limit"), entry.text("unit"), entry.flag("against")});
    });
    return decisions;
}

// Belongs to the round that it names, or to a candidate that was refused.
void decision_of(Fields& fields, Diagnosis& diagnosis) {
    const Effect& effect = effect_of(fields);
    const std::string outcome = fields.text("outcome");
    if (!fields.has("round")) {
        diagnosis.refused.push_back({{&effect, {}}, rules_of(fields)});
        return;
    }
    const std::size_t round = fields.whole("round");
    if (round < 1 || round > diagnosis.rounds.size())
        raise<DataError>("{} is {}, expected one of {} rounds", fields.where("round"), round,
                         diagnosis.rounds.size());
    Finding& finding = diagnosis.rounds[round - 1];
    if (outcome != status_name(finding.status) || &effect != finding.term.effect)
        raise<DataError>("{} is not what rounds[{}] says", fields.where("outcome"), round - 1);
    finding.decisions = rules_of(fields);
}

void accepted_of(Fields& fields, Diagnosis& diagnosis) {
    AcceptedFinding one;
    const std::size_t place = diagnosis.baseline.terms.size() + diagnosis.accepted.size();
    one.term = fitted_term_of(fields, place, one.values);
    one.status = enumerator_of(fields, "status", FindingStatus::not_reproduced, status_name);
    if (fields.has("reason")) one.reason = fields.text("reason");
    diagnosis.values.insert(diagnosis.values.end(), one.values.begin(), one.values.end());
    diagnosis.accepted.push_back(std::move(one));
}

// Everything that was found, beside the model.
void findings_of(Fields& fields, Diagnosis& diagnosis) {
    fields.each("own_terms", [&](Fields& entry) {
        const Term fitted = fitted_term_of(entry, diagnosis.baseline.terms.size(), diagnosis.values);
        diagnosis.baseline.terms.push_back({fitted.effect, {}});
        diagnosis.baseline.terms.back().values.resize(fitted.values.size());
    });
    if (fields.has("accepted"))
        fields.each("accepted", [&](Fields& entry) { accepted_of(entry, diagnosis); });
    const std::size_t own = diagnosis.baseline.terms.size() + diagnosis.accepted.size();
    fields.each("rounds", [&](Fields& entry) {
        diagnosis.rounds.push_back(finding_at(entry, own + diagnosis.rounds.size()));
    });
    // Older files do not tell what was decided by.
    if (fields.has("decisions"))
        fields.each("decisions", [&](Fields& entry) { decision_of(entry, diagnosis); });
    fields.each("faults", [&](Fields& entry) {
        std::vector<FittedValue> none;
        const Term term = fitted_term_of(entry, 0, none);
        diagnosis.faults.push_back(
            {term, entry.whole("samples"), spans_of(entry, "time_s"), entry.text("words")});
    });
    fields.each("ambiguous", [&](Fields& entry) {
        diagnosis.ambiguous.push_back({entry.texts("effects"), entry.text("advice")});
    });
    fields.each("undecidable", [&](Fields& entry) {
        diagnosis.undecidable.push_back(
            {effect_of(entry).name, entry.text("reason"), number_or_unknown(entry, "would_explain_nm")});
    });
    diagnosis.unexplained = regions_of(fields, "unexplained");
    diagnosis.disagreement = regions_of(fields, "disagreement");
}

}  // namespace

Diagnosis read_diagnosis(std::string_view text, const std::string& source) {
    const Json json = parse_document(text, source, "diagnosis");
    Fields fields(json, source, "");
    fields.ignore_head();
    // Of the model as given, and who says it; what was given beside it; what was written beside it. The
    // chance that a name is wrong follows from the rest.
    fields.ignore({"gear", "arm", "mjcf", "plan", "wrong_percent", "setup", "alignment", "samples_not_used",
                   "acts_where_not_used"});
    Diagnosis diagnosis;
    diagnosis.verdict = enumerator_of(fields, "verdict", DiagnosisVerdict::undecided, verdict_name);
    if (fields.has("doubt")) diagnosis.doubt = fields.text("doubt");
    diagnosis.named = fields.texts("named");
    findings_of(fields, diagnosis);
    diagnosis.gap = gap_of(fields);
    read_beside(fields, diagnosis);
    read_decided(fields, diagnosis);
    diagnosis.samples = fields.whole("samples");
    diagnosis.samples_used = fields.whole("samples_used");
    diagnosis.has_position = fields.flag("position_in_log");
    read_angle(fields, diagnosis);
    Fields search = fields.object("search");
    diagnosis.evaluations = search.number("evaluations");
    diagnosis.search_ended = search.flag("ended");
    search.finish();
    diagnosis.noise_color = fields.numbers("noise_color");
    diagnosis.false_alarm = fields.number("false_alarm");
    Fields model = fields.object("model");
    model.ignore({"schema"});
    diagnosis.model = model_of(model, is_given(diagnosis.given, "simulated"));
    model.finish();
    diagnosis.baseline.gear_ratio = diagnosis.model.gear_ratio;
    fields.finish();
    return diagnosis;
}

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
