// SPDX-License-Identifier: MIT
#pragma once
// What a fit tells of the errors of its coordinates.

#include <cstddef>
#include <span>
#include <vector>

#include "model/fit/weighing.hpp"

namespace ripplenotch {

/// Covariance of coordinates whose slopes along the fitted rows stand one after another in `slopes`, each
/// as long as `residual`; row by row, -1 where the log does not tell one of the two. `stretch`: samples in a
/// stretch of the log over which noise remembers, 0 for white noise.
[[nodiscard]] std::vector<double> covariance_of(std::span<const double> slopes,
                                                std::span<const double> residual, const Weighing& weighing,
                                                std::size_t stretch);

}  // namespace ripplenotch
