// SPDX-License-Identifier: MIT
#pragma once
// How sure each finding is: what it alone explains, whether it does so all over the log, and who could stand
// in its place.

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "diagnose/case/case.hpp"
#include "diagnose/judging/doubt.hpp"
#include "diagnose/search/model_bench.hpp"
#include "diagnose/search/screening.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {

// The values that are told in the end, with their intervals.

/// What is told of: the findings belong to the terms from `own_terms` on, those in doubt to none.
struct ToldOf {
    const std::vector<Fault>& faults;
    std::vector<Finding>& findings;
    std::size_t own_terms = 0;
};

/// The values of a model that is chosen, from samples that pull them to no side, with intervals that hold for
/// noise with a memory and for what the model lacks here and there. A finding whose size these values do not
/// tell (doubt.most_error) is unidentifiable, and its term goes.
[[nodiscard]] Candidate final_values(Case looked_at, const NoiseFloor& noise, const Candidate& chosen,
                                     const ToldOf& of, Work& work, const DiagnosisRules& rules);

// Noise may wander more slowly than the log is long: a zero that strolls, flicker noise. No colour of sixteen
// lags knows that. So what a slow finding explains is held against what the log does by itself, nearly as
// slowly.

/// `raw_gain_nm2`, what term `term` of `stated` explains, in units of the mean square that a wave a little
/// faster than it holds of what is left: rules.wandering.waves of them, of rules.wandering.slow_waves half
/// periods over the log and one more each. Empty where the term's torque is no slow one: less than
/// rules.wandering.slow_part of its square lies below them.
[[nodiscard]] std::optional<double> above_wandering(const ModelBench& bench, const Model& stated,
                                                    std::size_t term, double raw_gain_nm2);

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

// Findings held against a log that nothing was fitted to.

/// `model` without those findings that predict `other` worse than it is predicted without them, the worst
/// first, and without the newest until the whole predicts it no worse than `given`, the model without any
/// of them; their status says so. `findings`: one a term from `own_terms` on of `all`, the model with the
/// doubtful ones; `model` holds those of them that are not doubtful. Each finding gets the residual of
/// `other` without and with it.
[[nodiscard]] Candidate reproduced(const ModelBench& bench, const Candidate& all, const Candidate& model,
                                   const Model& given, const Case& other, std::size_t own_terms,
                                   std::vector<Finding>& findings);

}  // namespace ripplenotch
