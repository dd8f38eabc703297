// SPDX-License-Identifier: MIT
#pragma once
// What a diagnosis comes to: names, gaps, verdict.

#include <vector>

#include "diagnose/case/residual.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {

/// Fills in `named` and `ambiguous` from the rounds.
void name_findings(Diagnosis& diagnosis, const DiagnosisRules& rules);

/// A log before and after: its torque less what given terms bring, as they stand and with the values that
/// were fitted. Without given terms both are the same.
struct GapCase {
    const Case& as_given;
    const Case& improved;
};

/// Gaps are over every sample, so that they are what `simulate` says of the same model and log. `validation`
/// may be absent.
void measure_gap(Diagnosis& diagnosis, const GapCase& whole, const GapCase* validation,
                 const DiagnosisRules& rules);

[[nodiscard]] DiagnosisVerdict verdict_of(const Diagnosis& diagnosis);

}  // namespace ripplenotch
