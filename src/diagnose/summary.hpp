// SPDX-License-Identifier: MIT
#pragma once
// What a diagnosis comes to: names, gaps, verdict.

#include <vector>

#include "diagnose/case.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {

/// Of the values that `use` counts.
[[nodiscard]] double rms_of(const std::vector<double>& values, const std::vector<unsigned char>& use);

/// Fills in `named` and `ambiguous` from the rounds.
void name_findings(Diagnosis& diagnosis, const DiagnosisRules& rules);

/// Gaps are over every sample, so that they are what `simulate` says of the same model and log. `validation`
/// may be absent.
void measure_gap(Diagnosis& diagnosis, const Case& whole, const Case* validation,
                 const DiagnosisRules& rules);

[[nodiscard]] DiagnosisVerdict verdict_of(const Diagnosis& diagnosis);

}  // namespace ripplenotch
