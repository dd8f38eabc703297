// SPDX-License-Identifier: MIT
#pragma once
// The content of a residual besides noise, and where it is: tests against time, tones, orders, position and
// speed.

#include <vector>

#include "diagnose/limits.hpp"
#include "diagnose/search/model_bench.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {

/// Disagreements of the model with the log that are both significant and large enough to matter, the largest
/// first.
[[nodiscard]] std::vector<ResidualRegion> residual_regions(const ModelBench& bench, const Model& stated);

/// True when the region is confined to less than limits::regions::confined_part of the log's time, so that
/// the rest of the log can be diagnosed without it.
[[nodiscard]] bool is_confined(const ResidualRegion& region, const Case& looked_at);

}  // namespace ripplenotch
