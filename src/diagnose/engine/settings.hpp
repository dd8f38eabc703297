// SPDX-License-Identifier: MIT
#pragma once
// Every number by which the engine decides, each with its reason. Grids and bounds of single values are with
// their terms (terms.cpp).

#include <cstddef>

namespace ripplenotch::engine {

/// Penalty of one fitted number, in squares of the whitened noise: twice log(rows) / 2 of 40,000 rows, as of
/// the Bayesian information criterion. Logs are decided alike from 6 to 20.
inline constexpr double penalty_per_value = 10.0;
/// Reduction beyond the penalty that a term needs: odds of 400 to 1.
inline constexpr double least_reduction = 12.0;
/// Mean reduction of a block over its standard error: one stretch of the log must not decide.
inline constexpr double least_block_t = 4.0;
/// rms torque of a term in units of the noise, below which it is there and does not matter.
inline constexpr double least_noise_share = 0.3;
/// Share of the squares still to be explained that a term must take: else it corrects the form of another.
inline constexpr double least_gap_share = 0.1;
/// Share of the whole gap above which a term is accepted although few blocks carry it, as those of a drift
/// do.
inline constexpr double dominant_gap_share = 0.4;
/// Length of a block: longer than what remains correlated after whitening, short enough for many blocks.
inline constexpr double block_s = 1.0;
/// Groups of blocks that are left out in turn.
inline constexpr std::size_t fold_count = 8;
/// Candidates whose values are refined in each step: the best by grid is not always the best refined.
inline constexpr std::size_t finalist_count = 7;
/// Difference of the criterion at which one model is better than another.
inline constexpr double clearly_better = 8.0;
/// Difference within which two explanations are equally good: odds of 400 to 1, as 2 log(odds).
inline constexpr double tie_margin = 12.0;
/// A plainer term is preferred if it reaches this share of the other's reduction.
inline constexpr double plain_delay_share = 0.985;
inline constexpr double plain_friction_share = 0.96;
/// Below this share of the rms speed for longer than `standstill_s` the joint is at standstill, where
/// friction takes any value.
inline constexpr double standstill_speed_share = 0.01;
inline constexpr double standstill_s = 0.15;
/// Order of the autoregression of the noise: residual correlation beyond it was within its own error.
inline constexpr std::size_t noise_order = 12;

}  // namespace ripplenotch::engine
