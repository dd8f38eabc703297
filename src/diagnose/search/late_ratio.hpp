// SPDX-License-Identifier: MIT
#pragma once
// A gear ratio that is wrong and a torque that is late hide each other: without the delay no ratio puts the
// ripple on a line, and without the ratio no delay does. They are looked for together.

#include <optional>
#include <span>

#include "diagnose/search/model_bench.hpp"

namespace ripplenotch {

/// The case as a torque that is `late` sees it: each sample with the position of that much earlier. Samples
/// whose earlier position is not in the same stretch do not count.
[[nodiscard]] Case seen_late(const Case& looked_at, Seconds late);

/// Delays of the model's terms, in all.
[[nodiscard]] Seconds lateness_of(const Model& stated);

/// The model with a delay and a gear ratio that together make the ripple's lines stand out by
/// rules.screening.late_ratio of what the best ratio makes of them alone; fitted. One of the two that the
/// search has added gives way to the pair. None where the first `own_terms` terms hold one, where the model
/// has both, where they are not among `effects`, or where no delay makes that much.
[[nodiscard]] std::optional<Candidate> with_late_ratio(const ModelBench& bench, const Candidate& now,
                                                       std::size_t own_terms,
                                                       std::span<const Effect* const> effects);

}  // namespace ripplenotch
