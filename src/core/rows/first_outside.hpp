// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <span>

namespace ripplenotch {

/// Index of the first value whose magnitude is not within low < |value| <= high, as no NaN is; values.size()
/// when all are.
[[nodiscard]] std::size_t first_outside(std::span<const double> values, double low, double high) noexcept;

/// The same for the first value whose step from the value before is not within low < step <= high. The first
/// of all has no step.
[[nodiscard]] std::size_t first_step_outside(std::span<const double> values, double low,
                                             double high) noexcept;

}  // namespace ripplenotch
