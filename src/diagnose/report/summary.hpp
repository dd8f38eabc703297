// SPDX-License-Identifier: MIT
#pragma once
// The results of a diagnosis: names, gaps, verdict.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "diagnose/case/case.hpp"
#include "diagnose/case/known_torque.hpp"
#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {

// Rows of the log that do not count, and effects that act mainly there: such an effect is not found, however
// large it is.

/// Adds the rows that the case lacks in addition to those that are listed, where there are any.
void add_unused_rows(std::vector<UnusedRows>& listed, const Case& whole, std::string_view reason);

/// Those of these effects that have half of their largest torque or more mainly in rows that do not count,
/// each by itself with the sizes at which a search begins.
[[nodiscard]] std::vector<EffectOfUnusedRows> mainly_unused(std::span<const Effect* const> effects,
                                                            const Case& whole, const Model& model);

/// Fills in `named` and `ambiguous` from the rounds.
void name_findings(Diagnosis& diagnosis);

/// A log before and after: its torque less what given terms bring, as they stand and with the values that
/// were fitted. Without given terms both are the same.
struct GapCase {
    const Case& as_given;
    const Case& improved;
};

/// Gaps are over every sample, so that they equal those of `simulate` for the same model and log.
/// `validation` may be absent.
void measure_gap(Diagnosis& diagnosis, const GapCase& whole, const GapCase* validation);

[[nodiscard]] DiagnosisVerdict verdict_of(const Diagnosis& diagnosis);

}  // namespace ripplenotch
