// SPDX-License-Identifier: MIT
#pragma once
// The evidence for each finding: the torque that it alone explains, whether it does so all over the log, and
// which rivals could replace it.

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "diagnose/case/case.hpp"
#include "diagnose/judging/doubt.hpp"
#include "diagnose/limits.hpp"
#include "diagnose/search/model_bench.hpp"
#include "diagnose/search/screening.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {

// The reported values, with their intervals.

/// What is reported: the findings belong to the terms from `own_terms` on, uncertain ones to none.
struct ToldOf {
    const std::vector<Fault>& faults;
    std::vector<Finding>& findings;
    std::size_t own_terms = 0;
};

/// The values of a selected model, from samples that do not bias them, with intervals that hold for coloured
/// noise and for local model errors. A finding whose size is not identifiable from these values
/// (doubt.most_error) is unidentifiable, and its term is removed.
[[nodiscard]] Candidate final_values(Case looked_at, const NoiseFloor& noise, const Candidate& chosen,
                                     const ToldOf& of, Work& work);

// Noise may drift more slowly than the log is long: a random walk of the zero, flicker noise. A whitening
// filter of sixteen lags does not represent that. So the reduction of squares by a slow finding is compared
// with the drift of the log at frequencies nearly as low.

/// `raw_gain_nm2`, the reduction of squares by term `term` of `stated`, in units of the mean square of waves
/// a little faster than it in the residual: limits::wandering::waves of them, of
/// limits::wandering::slow_waves half periods over the log and one more each. Empty where the term's torque
/// is not slow: less than limits::wandering::slow_part of its square lies below them.
[[nodiscard]] std::optional<double> above_wandering(const ModelBench& bench, const Model& stated,
                                                    std::size_t term, double raw_gain_nm2);

/// A finding for each term from `own_terms` on, in their order. `unexplained`: regions of the residual.
[[nodiscard]] std::vector<Finding> judge(const ModelBench& bench, const Candidate& model,
                                         std::size_t own_terms, std::span<const Effect* const> effects,
                                         const std::vector<ResidualRegion>& unexplained);

/// Tests one term as a finding, whatever else there is.
[[nodiscard]] Finding judged_alone(const ModelBench& bench, const Candidate& model, std::size_t term,
                                   std::span<const Effect* const> effects,
                                   const std::vector<ResidualRegion>& unexplained);

/// The model without uncertain findings. The remaining ones are tested once more without these: together with
/// a surrogate of its own domain a finding may pass that does not by itself, and a curve over the speed has
/// to be ahead of another by more than they explained.
[[nodiscard]] Candidate believed(const ModelBench& bench, const Candidate& model, std::size_t own_terms,
                                 std::vector<Finding>& findings);

/// The advice of the catalogue for distinguishing two effects; a general one when it has none.
[[nodiscard]] std::string what_would_tell(const Effect& one, const Effect& other);

// Findings tested on a held-out log.

/// `model` without those findings that predict `other` worse than it is predicted without them, the worst
/// first, and without the newest until the whole predicts it no worse than `given`, the model without any of
/// them; their status reports it. `findings`: one a term from `own_terms` on of `all`, the model with the
/// uncertain ones; `model` holds those of them that are not uncertain. Each finding gets the residual of
/// `other` without and with it.
[[nodiscard]] Candidate reproduced(const ModelBench& bench, const Candidate& all, const Candidate& model,
                                   const Model& given, const Case& other, std::size_t own_terms,
                                   std::vector<Finding>& findings);

}  // namespace ripplenotch
