// SPDX-License-Identifier: MIT
#pragma once
// Which effects to add to a model: the best first, as long as each is worth its price; then whatever later
// ones made needless is dropped, and each is tried against its rivals.

#include <span>
#include <vector>

#include "diagnose/screening.hpp"

namespace ripplenotch {

/// The user's terms and no others, fitted.
[[nodiscard]] Candidate baseline(const ModelBench& bench, const Model& model);

/// `start` with what should be added. `own_terms`: how many of its terms are the user's and stay.
[[nodiscard]] Candidate search(ModelBench& bench, const Candidate& start, std::size_t own_terms,
                               std::span<const Effect* const> effects);

[[nodiscard]] Candidate without_term(const ModelBench& bench, const Candidate& model, std::size_t term);
[[nodiscard]] Candidate with_trial(const ModelBench& bench, const Candidate& model, const Trial& trial);

/// A rival that explains the log as well but for this gain is not told from a finding.
inline constexpr double tie_margin = 12.0;

/// Share of the noise floor below which a finding does not matter. Steps coarser than the noise bend whatever
/// is in the torque into shapes of their own, which are no effects.
[[nodiscard]] inline double material_sigma(const Case& looked_at) {
    return looked_at.step_nm > 0.0 ? 0.3 : 0.12;
}

}  // namespace ripplenotch
