// SPDX-License-Identifier: MIT
#pragma once
// Every effect of the catalogue, at every place at which a search for it may begin, tried on a thinned log:
// how much of the gap each would close. What comes out is a ranking; the fit of the whole log decides.

#include <span>
#include <vector>

#include "diagnose/search/model_bench.hpp"

namespace ripplenotch {

/// The best trial of each effect in `effects`, the best first. Effects on which the log carries no
/// information in addition to the model are not in it.
[[nodiscard]] std::vector<Trial> screen(const ModelBench& bench, const Candidate& model,
                                        std::span<const Effect* const> effects);

}  // namespace ripplenotch
