// SPDX-License-Identifier: MIT
#pragma once
// Selection of the effects to add to a model: the best first, as long as each is worth its penalty; then
// terms that later ones made needless are dropped, and each is compared with its rivals.

#include <span>
#include <vector>

#include "diagnose/search/screening.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {

/// The user's terms and no others, fitted.
[[nodiscard]] Candidate baseline(const ModelBench& bench, const Model& model);

/// `start` with what should be added. `own_terms`: how many of its terms are the user's and stay. `refused`:
/// the candidates that were not added in the last step, and why.
[[nodiscard]] Candidate search(ModelBench& bench, const Candidate& start, std::size_t own_terms,
                               std::span<const Effect* const> effects,
                               std::vector<RefusedCandidate>& refused);

[[nodiscard]] Candidate without_term(const ModelBench& bench, const Candidate& model, std::size_t term);
[[nodiscard]] Candidate with_trial(const ModelBench& bench, const Candidate& model, const Trial& trial);
/// The candidate with the best addition from its own screening, or as it is.
[[nodiscard]] Candidate one_ahead(const ModelBench& bench, const Candidate& candidate,
                                  std::span<const Effect* const> effects);

}  // namespace ripplenotch
