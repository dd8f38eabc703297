// SPDX-License-Identifier: MIT
#pragma once
// Findings beside a leftover as part of a diagnosis.

#include "diagnose/beside/finding/beside.hpp"

namespace ripplenotch {

/// Appends the outcome's findings to the rounds, with the gap before and after each, and gives the model with
/// those that are believed at its end. `model`: what was always on.
[[nodiscard]] Candidate adopt(Diagnosis& diagnosis, BesideOutcome outcome, const Candidate& model,
                              const ModelBench& bench);

/// Where today's search has left something unexplained above the floor: what is there beside it. A tentative
/// finding of the same name gives way. `other`: the validation log, if there is one.
[[nodiscard]] Candidate with_findings_beside(Diagnosis& diagnosis, const ModelBench& bench,
                                             const Candidate& last, const Case* other,
                                             std::span<const Effect* const> effects);

}  // namespace ripplenotch
