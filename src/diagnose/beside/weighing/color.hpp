// SPDX-License-Identifier: MIT
#pragma once
// The colour of what a model leaves, however long its memory: what friction is judged against whose reversal
// takes milliseconds beside a leftover that takes seconds.

#include <cstddef>
#include <span>
#include <vector>

namespace ripplenotch {

/// Coefficients a1 ... ap of e(k) = a1 e(k-1) + ... + ap e(k-p) + white, by the equations of Yule and Walker
/// with the autocovariance over all of `left`, its mean taken off. `floor`: part of the power that is taken
/// for white besides, so that a band without power is not made loud. Empty where `left` does not change.
[[nodiscard]] std::vector<double> long_color(std::span<const double> left, std::size_t p, double floor);

}  // namespace ripplenotch
