// SPDX-License-Identifier: MIT
#pragma once
// Findings held against a log that nothing was fitted to.

#include <vector>

#include "diagnose/search/model_bench.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {

/// `model` without those findings that predict `other` worse than it is predicted without them, the worst
/// first, and without the newest until the whole predicts it no worse than `given`, the model without any
/// of them; their status says so. `findings`: one a term from `own_terms` on of `all`, the model with the
/// doubtful ones; `model` holds those of them that are not doubtful. Each finding gets the residual of
/// `other` without and with it.
[[nodiscard]] Candidate reproduced(const ModelBench& bench, const Candidate& all, const Candidate& model,
                                   const Model& given, const Case& other, std::size_t own_terms,
                                   std::vector<Finding>& findings);

}  // namespace ripplenotch
