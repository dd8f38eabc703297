// SPDX-License-Identifier: MIT
#pragma once
// Internal to the analysis room: whether estimates disagree by more than their errors say.

namespace ripplenotch {

/// By what factor errors are too small, when estimates of one value scatter about their weighted mean with
/// `squares` = sum (estimate - mean)^2 / variance on `freedom` degrees of freedom: sqrt(squares / freedom)
/// (Birge 1932), where chance gives such scatter less than once in a hundred times; else 1. An error that is
/// widened by every scatter above the mean one would cover too often, and one that is never widened too
/// seldom.
[[nodiscard]] double excess_scatter(double squares, double freedom);

}  // namespace ripplenotch
