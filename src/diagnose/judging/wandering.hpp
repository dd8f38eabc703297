// SPDX-License-Identifier: MIT
#pragma once
// Noise may wander more slowly than the log is long: a zero that strolls, flicker noise. No colour of sixteen
// lags knows that. So what a slow finding explains is held against what the log does by itself, nearly as
// slowly.

#include <cstddef>
#include <optional>

#include "diagnose/search/model_bench.hpp"

namespace ripplenotch {

/// `raw_gain_nm2`, what term `term` of `stated` explains, in units of the mean square that a wave a little
/// faster than it holds of what is left: rules.wandering.waves of them, of rules.wandering.slow_waves half
/// periods over the log and one more each. Empty where the term's torque is no slow one: less than
/// rules.wandering.slow_part of its square lies below them.
[[nodiscard]] std::optional<double> above_wandering(const ModelBench& bench, const Model& stated,
                                                    std::size_t term, double raw_gain_nm2);

}  // namespace ripplenotch
