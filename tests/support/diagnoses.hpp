// SPDX-License-Identifier: MIT
#pragma once
// A diagnosis with something in every part of it.

#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/document/results.hpp"

namespace ripplenotch::testing {

inline GearAccount known_gear() { return {GearRatio(100.0), {}, {}, {}, "--gear-ratio"}; }

inline std::string document_of(const Diagnosis& diagnosis) {
    return write_diagnosis({"", diagnosis, known_gear()}, {});
}

inline Finding coulomb_finding() {
    Finding finding;
    finding.term = parse_term("coulomb-friction,torque_nm=0.49985,width_deg_s=2");
    finding.values = {{1, 0, 0.49985, {}, Interval{0.4987246838, 0.5009686948}, false}};
    finding.evidence = {773388.0, 34.9626, 8.70051, 0.959804};
    finding.alternatives = {{parse_term("offset,torque_nm=0.4"), 2.5}};
    finding.gap_before_nm = 0.434974;
    finding.gap_after_nm = 0.0496759;
    finding.validation_before_nm = 0.433479;
    finding.validation_after_nm = 0.0503318;
    return finding;
}

inline Finding tone_finding() {
    Finding finding;
    finding.term = parse_term("tone,frequency_hz=50,amplitude_nm=0.02,phase_deg=10");
    finding.status = FindingStatus::ambiguous;
    finding.reason = "another effect explains as much";
    finding.values = {{2, 0, 50.0, {}, Interval{49.9, 50.1}, false}, {2, 1, 0.02, {}, {}, true}};
    finding.evidence.noise_share = 0.298;
    finding.gap_before_nm = 0.0496759;
    finding.gap_after_nm = 0.0475;
    return finding;
}

inline Diagnosis full_diagnosis() {
    Diagnosis diagnosis;
    diagnosis.verdict = DiagnosisVerdict::partly_explained;
    diagnosis.doubt = "another reading of the log is possible";
    diagnosis.baseline = {GearRatio(100.0), {parse_term("inertia,inertia_kgm2=0.4")}};
    diagnosis.rounds = {coulomb_finding(), tone_finding()};
    diagnosis.model = diagnosis.baseline;
    for (const Finding& finding : diagnosis.rounds) diagnosis.model.terms.push_back(finding.term);
    diagnosis.values = {{0, 0, 0.4, {}, Interval{0.39, 0.41}, false}};
    diagnosis.faults = {{parse_term("quantization,step_nm=0.01"), 12, {{1.5, 1.5}}, "steps of 0.01 Nm"}};
    diagnosis.named = {"coulomb-friction"};
    diagnosis.ambiguous = {{{"tone", "ripple"}, "move at another speed"}};
    diagnosis.refused = {{parse_term("lag,time_constant_s=0.01"), "few stretches of the log carry it"}};
    diagnosis.remaining = RemainingResidual{0.0575, RegionKind::time, {3.0, 3.5}, 0.625};
    diagnosis.undecidable = {{find_effect("gravity").name, "the log has no position"}};
    diagnosis.gap = {0.434974, 0.0475, 0.0474, 99.9, {}, {}, {}};
    diagnosis.samples = 9050;
    diagnosis.samples_used = 9000;
    diagnosis.smoothing_s = 0.025;
    diagnosis.has_position = true;
    return diagnosis;
}

}  // namespace ripplenotch::testing
