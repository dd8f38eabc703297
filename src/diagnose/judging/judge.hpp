// SPDX-License-Identifier: MIT
#pragma once
// How sure each finding is: what it alone explains, whether it does so all over the log, and who could stand
// in its place.

#include <span>
#include <vector>

#include "diagnose/judging/doubt.hpp"
#include "diagnose/search/screening.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {

/// A finding for each term from `own_terms` on, in their order. `unexplained`: what is left over.
[[nodiscard]] std::vector<Finding> judge(const ModelBench& bench, const Candidate& model,
                                         std::size_t own_terms, std::span<const Effect* const> effects,
                                         const std::vector<ResidualRegion>& unexplained);

/// One term, as if it were a finding, whatever else there is.
[[nodiscard]] Finding judged_alone(const ModelBench& bench, const Candidate& model, std::size_t term,
                                   std::span<const Effect* const> effects,
                                   const std::vector<ResidualRegion>& unexplained);

/// The model without findings that are in doubt. Those that stay are looked at once more without these:
/// beside a surrogate of its own domain a finding may look right that does not by itself, and a curve over
/// the speed has to be ahead of another by more than they took up.
[[nodiscard]] Candidate believed(const ModelBench& bench, const Candidate& model, std::size_t own_terms,
                                 std::vector<Finding>& findings);

/// The advice of the catalogue for telling two effects apart; a general one when it has none.
[[nodiscard]] std::string what_would_tell(const Effect& one, const Effect& other);

}  // namespace ripplenotch
