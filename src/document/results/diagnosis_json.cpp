// SPDX-License-Identifier: MIT
#include "ripplenotch/document/results.hpp"

#include <algorithm>
#include <iterator>

#include "document/fields/fields.hpp"
#include "document/fields/result_fields.hpp"
#include "ripplenotch/arm/arm_fit.hpp"
#include "ripplenotch/arm/arm_setup.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/diagnose/friction_table.hpp"
#include "ripplenotch/export/joint_mjcf.hpp"

namespace ripplenotch {

namespace {

// A frequency is known to more digits than six.
constexpr Rounded ten{[](double value) { return finite_or_null(to_digits(value, 10) + 0.0); }};

// The values of a term, with their intervals where they are among `fitted`.
void describe_values(JsonWriter& json, const Term& term, const std::vector<FittedValue>& fitted = {}) {
    json.group("parameters", [&](JsonWriter& parameters) {
        for (std::size_t p = 0; p < term.values.size(); ++p) {
            const Parameter& parameter = term.effect->parameters[p];
            const auto found = std::ranges::find(fitted, p, &FittedValue::parameter);
            const bool is_fitted = found != fitted.end();
            parameters.group(parameter.name, [&](JsonWriter& entry) {
                entry("value", term.values[p].value_or(parameter.start), ten);
                entry("ci95", is_fitted ? found->ci95 : std::nullopt, ten);
                if (!is_fitted) entry("fitted", false);
                entry("at_bound", is_fitted && found->at_bound, if_any);
            });
        }
    });
}

// The terms at the head of a model, with those of `values` that were fitted.
void describe_terms(JsonWriter& json, std::string_view name, std::span<const Term> terms,
                    const std::vector<FittedValue>& values) {
    json.each(name, terms, [&](JsonWriter& entry, const Term& term) {
        std::vector<FittedValue> own;
        const auto place = static_cast<std::size_t>(&term - terms.data());
        std::ranges::copy_if(values, std::back_inserter(own),
                             [place](const FittedValue& value) { return value.term == place; });
        entry("effect", term.effect->name);
        describe_values(entry, term, own);
    });
}

}  // namespace

auto ends_of(const Span& span) { return std::tie(span.from, span.to); }

void describe(JsonWriter& json, const Evidence& evidence) {
    json("reduction", evidence.reduction, six);
    json("block_t", evidence.block_t, six);
    json("noise_share", evidence.noise_share, six);
    json("explained_share", evidence.explained_share, six);
}

void describe(JsonWriter& json, const RivalFinding& rival) {
    json("effect", rival.name());
    describe_values(json, rival.term);
    json("margin", rival.margin, six);
}

void describe(JsonWriter& json, const Finding& finding) {
    json("effect", finding.term.effect->name);
    json("status", status_name(finding.status));
    json("reason", finding.reason, if_any);
    describe_values(json, finding.term, finding.values);
    json("evidence", finding.evidence);
    json("alternatives", finding.alternatives);
    json("validation_before_nm", finding.validation_before_nm, six);
    json("validation_after_nm", finding.validation_after_nm, six);
    json("gap_before_nm", finding.gap_before_nm, six);
    json("gap_after_nm", finding.gap_after_nm, six);
}

void describe(JsonWriter& json, const AcceptedFinding& one) {
    json("effect", one.term.effect->name);
    json("status", status_name(one.status));
    json("reason", one.reason, if_any);
    describe_values(json, one.term);
}

void describe(JsonWriter& json, const RefusedCandidate& one) {
    json("effect", one.term.effect->name);
    describe_values(json, one.term);
    json("reason", one.reason);
}

void describe(JsonWriter& json, const Fault& fault) {
    json("effect", fault.term.effect->name);
    describe_values(json, fault.term);
    json("samples", fault.samples);
    json("time_s", fault.time_s, six);
    json("words", fault.words);
}

void describe(JsonWriter& json, const Tie& tie) {
    json("effects", tie.effects);
    json("advice", tie.advice);
}

void describe(JsonWriter& json, const RemainingResidual& left) {
    json("rms_nm", left.rms_nm, six);
    json("kind", region_kind_name(left.kind));
    json("where", left.where, six);
    json("part", left.part, six);
}

void describe(JsonWriter& json, const Undecidable& one) {
    json("effect", one.effect);
    json("reason", one.reason);
}

void describe(JsonWriter& json, const DiagnosisGap& gap) {
    json("before_nm", gap.before_nm, six);
    json("after_nm", gap.after_nm, six);
    json("noise_floor_nm", gap.noise_floor_nm, six);
    json("closed_percent", gap.closed_percent, six);
    json("validation_before_nm", gap.validation_before_nm, six);
    json("validation_after_nm", gap.validation_after_nm, six);
    json("validation_closed_percent", gap.validation_closed_percent, six);
}

void describe(JsonWriter& json, const BandGap& band) {
    json.put("hz", {six_digits(band.from_hz), band.to_hz > 0.0 ? six_digits(band.to_hz) : Json(nullptr)});
    json("torque_nm", band.torque_nm, six);
    json("beside_given_nm", band.beside_given_nm, six);
    json("after_nm", band.after_nm, six);
}

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

void describe(JsonWriter& json, const DriveAnswer& drive) {
    describe(json, drive.torque);
    json("position_before_deg", drive.position_before_deg, six);
    json("position_after_deg", drive.position_after_deg, six);
    json.group("position_of_deg", [&](JsonWriter& effects) {
        for (const auto& [effect, deg] : drive.position_of_effects_deg) effects(effect, deg, six);
    });
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

void add_model(JsonWriter& json, const Model& model) {
    json.group("model", [&](JsonWriter& own) {
        own("schema", "ripplenotch/model/1");
        describe(own, model);
    });
}

}  // namespace

void describe(JsonWriter& json, const DiagnosedJoint& joint) {
    const Diagnosis& diagnosis = joint.diagnosis;
    json("verdict", verdict_name(diagnosis.verdict));
    json("sentence", diagnosis_sentence(diagnosis));
    json("doubt", diagnosis.doubt, if_any);
    json("gear", joint.gear);
    json("named", diagnosis.named);
    json("rounds", diagnosis.rounds);
    json("refused", diagnosis.refused);
    json("faults", diagnosis.faults);
    json("ambiguous", diagnosis.ambiguous);
    json("remaining", diagnosis.remaining);
    json("undecidable", diagnosis.undecidable);
    json("gap", diagnosis.gap);
    // An arm's values are of combinations of links, which have no meaning one by one.
    if (const auto given = std::ranges::find(diagnosis.given, "simulated", &GivenValue::name);
        given != diagnosis.given.end())
        json.group("simulated", [&](JsonWriter& entry) { entry("scale", given->value, six); });
    json("setup", diagnosis.setup, if_any);
    json("alignment", diagnosis.alignment, if_any);
    json("drive", diagnosis.drive, if_any);
    json("bands", diagnosis.bands, if_any);
    json("accepted", diagnosis.accepted, if_any);
    json("next", diagnosis.next, if_any);
    json("arm", joint.arm, if_any);
    json("mjcf", joint.mjcf, if_any);
    describe_terms(json, "own_terms", std::span(diagnosis.model.terms).first(diagnosis.baseline.terms.size()),
                   diagnosis.values);
    json("samples", diagnosis.samples);
    json("samples_used", diagnosis.samples_used);
    json("smoothing_s", diagnosis.smoothing_s, six);
    json("position_in_log", diagnosis.has_position);
    add_model(json, diagnosis.model);
}

std::string write_diagnosis(const DiagnosedJoint& joint, const Provenance& provenance) {
    return to_fitted_text(document_of("diagnosis", provenance, joint));
}

std::string write_diagnoses(std::span<const DiagnosedJoint> joints, const Provenance& provenance) {
    return to_fitted_text(document_of("diagnoses", provenance, [&](JsonWriter& json) {
        json.each("joints", joints, [](JsonWriter& entry, const DiagnosedJoint& joint) {
            entry("joint", joint.joint);
            describe(entry, joint);
        });
    }));
}

void describe(JsonWriter& json, const TriedFriction& one) {
    json("effect", one.effect);
    json("found", one.found);
    json("chance", one.chance, six);
}

std::string write_friction(const FrictionDiagnosis& found, const Provenance& provenance) {
    return to_fitted_text(document_of("friction-table", provenance, [&](JsonWriter& json) {
        describe_terms(json, "terms", found.model.terms, found.values);
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
        add_model(json, found.model);
    }));
}

}  // namespace ripplenotch
