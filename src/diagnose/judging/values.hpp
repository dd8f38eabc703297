// SPDX-License-Identifier: MIT
#pragma once
// The values that are told in the end, with their intervals.

#include "diagnose/case/faults.hpp"
#include "diagnose/search/model_bench.hpp"

namespace ripplenotch {

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

}  // namespace ripplenotch
