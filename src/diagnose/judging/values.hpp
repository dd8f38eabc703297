// SPDX-License-Identifier: MIT
#pragma once
// The values that are told in the end, with their intervals.

#include "diagnose/case/faults.hpp"
#include "diagnose/search/model_bench.hpp"

namespace ripplenotch {

/// The values of a model that is chosen, from samples that pull them to no side, with intervals that hold for
/// noise with a memory and for what the model lacks here and there.
[[nodiscard]] Candidate told_values(Case looked_at, const NoiseFloor& noise, const Candidate& chosen,
                                    const std::vector<Fault>& faults, Work& work,
                                    const DiagnosisRules& rules);

}  // namespace ripplenotch
