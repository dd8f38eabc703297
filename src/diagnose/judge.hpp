// SPDX-License-Identifier: MIT
#pragma once
// How sure each finding is: what it alone explains, whether it does so all over the log, and who could stand
// in its place.

#include <span>
#include <vector>

#include "diagnose/screening.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {

/// A finding for each term from `own_terms` on, in their order. `unexplained`: what is left over.
[[nodiscard]] std::vector<Finding> judge(const Bench& bench, const Candidate& model, std::size_t own_terms,
                                         std::span<const Effect* const> effects,
                                         const std::vector<Leftover>& unexplained);

/// The advice of the catalogue for telling two effects apart; a general one when it has none.
[[nodiscard]] std::string what_would_tell(const Effect& one, const Effect& other);

}  // namespace ripplenotch
