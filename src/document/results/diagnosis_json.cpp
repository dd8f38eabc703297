// SPDX-License-Identifier: MIT
#include "ripplenotch/document/diagnosis_json.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "document/fields/fields.hpp"
#include "document/fields/result_fields.hpp"

namespace ripplenotch {

namespace {

constexpr std::string_view simulated = "simulated";

// A frequency is known to more digits than six.
constexpr Rounded ten{[](double value) { return finite_or_null(to_digits(value, 10) + 0.0); }};
constexpr Rounded ten_or_unknown{ten.json_of, true};

constexpr Names statuses{status_name, FindingStatus::refused};

// An effect of which the catalogue's name is kept.
template <class Archive>
void describe_effect_name(Archive& archive, auto& name) {
    if constexpr (Archive::reading) {
        const Effect* effect = nullptr;
        describe_effect(archive, effect);
        name = effect->name;
    } else {
        archive("effect", name);
    }
}

// The values of a term; those that were fitted are among `fitted`, whose place in the model the reader leaves
// to the caller.
template <class Archive>
void describe_parameters(Archive& archive, auto& term, auto& fitted) {
    archive.group("parameters", [&](Archive& parameters) {
        if constexpr (Archive::reading) term.values.resize(term.effect->parameters.size());
        for (std::size_t p = 0; p < term.values.size(); ++p) {
            const Parameter& parameter = term.effect->parameters[p];
            FittedValue one;
            bool is_fitted = true;
            if constexpr (!Archive::reading) {
                const auto found = std::find_if(fitted.begin(), fitted.end(), [p](const FittedValue& value) {
                    return value.parameter == p;
                });
                is_fitted = found != fitted.end();
                if (is_fitted) one = *found;
                one.value = term.values[p].value_or(parameter.start);
            }
            parameters.group(parameter.name, [&](Archive& entry) {
                entry("value", one.value, ten_or_unknown);
                entry("ci95", one.ci95, ten);
                if (entry.holds("fitted", !is_fitted)) entry("fitted", is_fitted);
                entry("at_bound", one.at_bound, if_any);
            });
            if constexpr (Archive::reading) {
                one.parameter = p;
                if (!std::isnan(one.value)) term.values[p] = one.value;
                if (is_fitted) fitted.push_back(one);
            }
        }
    });
}

// An effect with its values, of which none was fitted.
template <class Archive>
void describe_stated(Archive& archive, auto& term) {
    std::vector<FittedValue> none;
    describe_effect(archive, term.effect);
    describe_parameters(archive, term, none);
}

}  // namespace

auto ends_of(Is<Span> auto& span) { return std::tie(span.from, span.to); }

void describe(auto& archive, Is<Evidence> auto& evidence) {
    archive("reduction", evidence.reduction, six_or_unknown);
    archive("block_t", evidence.block_t, six_or_unknown);
    archive("noise_share", evidence.noise_share, six_or_unknown);
    archive("explained_share", evidence.explained_share, six_or_unknown);
}

void describe(auto& archive, Is<RivalFinding> auto& rival) {
    describe_stated(archive, rival.term);
    archive("margin", rival.margin, six_or_unknown);
}

// An effect with its status and its values.
void describe_named(auto& archive, auto& finding) {
    describe_effect(archive, finding.term.effect);
    archive("status", finding.status, statuses);
    archive("reason", finding.reason, if_any);
    describe_parameters(archive, finding.term, finding.values);
}

void describe(auto& archive, Is<Finding> auto& finding) {
    describe_named(archive, finding);
    archive("evidence", finding.evidence);
    archive("alternatives", finding.alternatives);
    archive("validation_before_nm", finding.validation_before_nm, six);
    archive("validation_after_nm", finding.validation_after_nm, six);
    archive("gap_before_nm", finding.gap_before_nm, six_or_unknown);
    archive("gap_after_nm", finding.gap_after_nm, six_or_unknown);
}

void describe(auto& archive, Is<AcceptedFinding> auto& one) {
    std::vector<FittedValue> none;
    describe_effect(archive, one.term.effect);
    archive("status", one.status, statuses);
    archive("reason", one.reason, if_any);
    describe_parameters(archive, one.term, none);
}

void describe(auto& archive, Is<RefusedCandidate> auto& one) {
    describe_stated(archive, one.term);
    archive("reason", one.reason);
}

void describe(auto& archive, Is<Fault> auto& fault) {
    describe_stated(archive, fault.term);
    archive("samples", fault.samples);
    archive("time_s", fault.time_s, six);
    archive("words", fault.words);
}

void describe(auto& archive, Is<Tie> auto& tie) {
    archive("effects", tie.effects);
    archive("advice", tie.advice);
}

void describe(auto& archive, Is<RemainingResidual> auto& left) {
    archive("rms_nm", left.rms_nm, six_or_unknown);
    archive("kind", left.kind, Names{region_kind_name, RegionKind::tone});
    archive("where", left.where, six);
    archive("part", left.part, six_or_unknown);
}

void describe(auto& archive, Is<Undecidable> auto& one) {
    describe_effect_name(archive, one.effect);
    archive("reason", one.reason);
}

void describe(auto& archive, Is<DiagnosisGap> auto& gap) {
    archive("before_nm", gap.before_nm, six_or_unknown);
    archive("after_nm", gap.after_nm, six_or_unknown);
    archive("noise_floor_nm", gap.noise_floor_nm, six_or_unknown);
    archive("closed_percent", gap.closed_percent, six);
    archive("validation_before_nm", gap.validation_before_nm, six);
    archive("validation_after_nm", gap.validation_after_nm, six);
    archive("validation_closed_percent", gap.validation_closed_percent, six);
}

template <class Archive>
void describe(Archive& archive, Is<BandGap> auto& band) {
    if constexpr (Archive::reading) {
        const std::vector<double> hz = archive.numbers("hz", true);
        if (hz.size() != 2 || std::isnan(hz[0])) raise<DataError>("{} is no band", archive.where("hz"));
        band.from_hz = hz[0];
        band.to_hz = std::isnan(hz[1]) ? 0.0 : hz[1];
    } else {
        archive.put("hz",
                    {six_digits(band.from_hz), band.to_hz > 0.0 ? six_digits(band.to_hz) : Json(nullptr)});
    }
    archive("torque_nm", band.torque_nm, six);
    archive("beside_given_nm", band.beside_given_nm, six);
    archive("after_nm", band.after_nm, six);
}

namespace {

// The terms of the model as given, with their values in the improved one.
template <class Archive>
void describe_own_terms(Archive& archive, auto& diagnosis) {
    auto& terms = diagnosis.baseline.terms;
    archive.each("own_terms", terms, [&](Archive& entry, auto& own) {
        const auto place = static_cast<std::size_t>(&own - terms.data());
        std::vector<FittedValue> values;
        Term term{own.effect, {}};
        if constexpr (!Archive::reading) {
            term.values = diagnosis.model.terms[place].values;
            std::copy_if(diagnosis.values.begin(), diagnosis.values.end(), std::back_inserter(values),
                         [&](const FittedValue& value) { return value.term == place; });
        }
        describe_effect(entry, term.effect);
        describe_parameters(entry, term, values);
        if constexpr (Archive::reading) {
            own = {term.effect, {}};
            own.values.resize(term.values.size());
            for (FittedValue& value : values) value.term = place;
            diagnosis.values.insert(diagnosis.values.end(), values.begin(), values.end());
        }
    });
}

// The values of what was found stand in the model behind its own terms and what was accepted.
void place_values(Diagnosis& diagnosis) {
    std::size_t place = diagnosis.baseline.terms.size();
    place += diagnosis.accepted.size();
    for (Finding& finding : diagnosis.rounds) {
        if (!finding.is_in_model()) continue;
        for (FittedValue& value : finding.values) value.term = place;
        ++place;
    }
}

}  // namespace

void describe(JsonWriter& json, const SetupFault& fault) {
    json("fault", setup_fault_name(fault.kind));
    json("statement", fault.statement);
    json("option", fault.option);
    json("explained_before", fault.explained_before, six);
    json("explained_after", fault.explained_after, six);
}

void describe(JsonWriter& json, const SimulationLag& lag) {
    json("delay_s", lag.delay_s, six);
    json("ci95_s", lag.delay_95_s, six);
    json("correlation", lag.correlation, six);
    json("clock_error_ppm", lag.clock_error, Times{1e6}, six);
}

void describe(JsonWriter& json, const JointTravel& joint) {
    json("name", joint.name);
    json("log", joint.log);
    json("travel_deg", joint.travel_deg, six);
}

void describe(JsonWriter& json, const ArmAccount& arm) {
    json("source", arm.source);
    json("matched", arm.rule);
    json("option", arm.option);
    json("joints", arm.joints);
    json("lengths_are_guessed", arm.lengths_are_guessed);
    json("smoothing_s", arm.smoothing);
    json("gap_before_nm", arm.gap_before_nm, six);
    json("values_are_stated", arm.values_are_stated, if_any);
    if (arm.values_are_stated) return;
    json("values_there", arm.values_there);
    json("ripple", arm.ripple, if_any);
    json("values_told", arm.values_told);
    json("all_joints_at_once", arm.all_joints_at_once);
    json("lambda", arm.pull);
    json("gap_nm", arm.gap_nm, six);
    if (!arm.lag) return;
    json.group("lag", [&](JsonWriter& lag) {
        lag("delay_s", arm.lag->delay_s, six);
        lag("ci95_s", arm.lag->delay_95_s, six);
        lag("applied", arm.lag_is_applied);
        lag.each("joints", arm.lag->joints, [&](JsonWriter& entry, const JointLag& joint) {
            entry("name", arm.joints.at(joint.joint).name);
            entry("delay_s", joint.delay_s, six);
            entry("contradicts", joint.contradicts);
        });
    });
}

void describe(JsonWriter& json, const MjcfAccount& mjcf) {
    json("file", mjcf.file);
    json.each("holds", mjcf.holds, [](JsonWriter& entry, const MjcfPart& part) {
        entry("effect", part.effect);
        entry("as", part.words);
    });
    json.each("not_held", mjcf.not_held, [](JsonWriter& entry, const MjcfPart& part) {
        entry("effect", part.effect);
        entry("reason", part.words);
    });
    json("gap_before_nm", mjcf.before_nm, six);
    json("gap_after_nm", mjcf.after_nm, six);
}

namespace {

// `joint`: what is written with a diagnosis and is no part of it; nullptr where it is read.
template <class Archive>
void describe_diagnosis(Archive& archive, auto& diagnosis, const DiagnosedJoint* joint) {
    archive("verdict", diagnosis.verdict, Names{verdict_name, DiagnosisVerdict::undecided});
    archive("doubt", diagnosis.doubt, if_any);
    archive.derived("gear", [&] { return &joint->gear; });
    archive("named", diagnosis.named);
    archive("rounds", diagnosis.rounds);
    archive("refused", diagnosis.refused);
    archive("faults", diagnosis.faults);
    archive("ambiguous", diagnosis.ambiguous);
    archive("remaining", diagnosis.remaining);
    archive("undecidable", diagnosis.undecidable);
    archive("gap", diagnosis.gap);
    // An arm's values are of combinations of links, which have no meaning one by one.
    const auto given = std::find_if(diagnosis.given.begin(), diagnosis.given.end(),
                                    [](const GivenValue& value) { return value.name == simulated; });
    double scale = given == diagnosis.given.end() ? 1.0 : given->value;
    if (archive.holds("simulated", given != diagnosis.given.end())) {
        archive.group("simulated", [&](Archive& entry) { entry("scale", scale, six); });
        if constexpr (Archive::reading) diagnosis.given.push_back({std::string(simulated), scale, {}});
    }
    archive.derived(
        "setup", [&] { return diagnosis.setup; }, if_any);
    archive.derived(
        "alignment", [&] { return diagnosis.alignment; }, if_any);
    archive("bands", diagnosis.bands, if_any);
    archive("accepted", diagnosis.accepted, if_any);
    archive("next", diagnosis.next, if_any);
    archive.derived(
        "arm", [&] { return joint->arm; }, if_any);
    archive.derived(
        "mjcf", [&] { return joint->mjcf; }, if_any);
    describe_own_terms(archive, diagnosis);
    archive("samples", diagnosis.samples);
    archive("samples_used", diagnosis.samples_used);
    archive("smoothing_s", diagnosis.smoothing_s, six);
    archive("position_in_log", diagnosis.has_position);
    archive.group("model", [&](Archive& model) {
        model.derived("schema", [] { return "ripplenotch/model/1"; });
        if constexpr (Archive::reading)
            diagnosis.model.beside_simulation = is_given(diagnosis.given, simulated);
        describe(model, diagnosis.model);
    });
    if constexpr (Archive::reading) {
        diagnosis.baseline.gear_ratio = diagnosis.model.gear_ratio;
        place_values(diagnosis);
    }
}

}  // namespace

void describe(JsonWriter& json, const DiagnosedJoint& joint) {
    json("joint", joint.joint);
    describe_diagnosis(json, joint.diagnosis, &joint);
}

Json parameters_json(const Term& term, const std::vector<FittedValue>& values) {
    return JsonWriter::object_of(
        [&](JsonWriter& json) { describe_parameters(json, term, values); })["parameters"];
}

std::string write_diagnosis(const Diagnosis& diagnosis, const GearAccount& gear, const Provenance& provenance,
                            const ArmAccount* arm, const MjcfAccount* mjcf) {
    const DiagnosedJoint joint{{}, diagnosis, gear, arm, mjcf};
    return to_fitted_text(document_of(
        "diagnosis", provenance, [&](JsonWriter& json) { describe_diagnosis(json, diagnosis, &joint); }));
}

std::string write_diagnoses(std::span<const DiagnosedJoint> joints, const Provenance& provenance) {
    return to_fitted_text(
        document_of("diagnoses", provenance, [&](JsonWriter& json) { json("joints", joints); }));
}

void describe(JsonWriter& json, const TriedFriction& one) {
    json("effect", one.effect);
    json("found", one.found);
    json("chance", one.chance, six);
}

std::string write_friction(const FrictionDiagnosis& found, const Provenance& provenance) {
    return to_fitted_text(document_of("friction-table", provenance, [&](JsonWriter& json) {
        json.each("terms", found.model.terms, [&](JsonWriter& entry, const Term& term) {
            std::vector<FittedValue> values;
            const auto place = static_cast<std::size_t>(&term - found.model.terms.data());
            std::ranges::copy_if(found.values, std::back_inserter(values),
                                 [place](const FittedValue& value) { return value.term == place; });
            describe_effect(entry, term.effect);
            describe_parameters(entry, term, values);
        });
        json("tried", found.tried);
        json("ambiguous", found.ambiguous);
        json("undecidable", found.undecidable);
        json("residual_nm", found.residual_nm, six);
        json("noise_nm", found.noise_nm, six);
        json("rows", found.rows);
        json("rows_at_rest", found.rows_at_rest);
        json("rows_positive", found.positive);
        json("rows_negative", found.negative);
        json("speed_deg_s", found.speed_deg_s, six);
        json("stribeck_examined_deg_s", found.stribeck_deg_s, six);
        json.group("model", [&](JsonWriter& model) {
            model.derived("schema", [] { return "ripplenotch/model/1"; });
            describe(model, found.model);
        });
    }));
}

Diagnosis read_diagnosis(std::string_view text, const std::string& source) {
    Diagnosis diagnosis;
    read_document(text, source, "diagnosis",
                  [&](JsonReader& reader) { describe_diagnosis(reader, diagnosis, nullptr); });
    return diagnosis;
}

}  // namespace ripplenotch
