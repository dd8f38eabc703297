// SPDX-License-Identifier: MIT
#include <limits>

#include "document/fields/angle_fields.hpp"
#include "document/fields/beside_fields.hpp"
#include "document/fields/decided_fields.hpp"
#include "document/fields/document_head.hpp"
#include "document/fields/fields.hpp"
#include "document/fields/model_fields.hpp"
#include "ripplenotch/core/error.hpp"
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

}  // namespace ripplenotch
