// SPDX-License-Identifier: MIT
#pragma once
// Every number by which the engine decides, each with its reason. Grids and bounds of single values are with
// their terms (terms.cpp).

namespace ripplenotch::engine {

/// Penalty of one fitted number, in squares of the whitened noise: twice log(rows) / 2 of 40,000 rows, as of
/// the Bayesian information criterion. Logs are decided alike from 6 to 20.
inline constexpr double penalty_per_value = 10.0;
/// Reduction beyond the penalty that a term needs, by which one model is better than another, and within
/// which two are equally good: odds of 400 to 1, as 2 log(odds).
inline constexpr double least_reduction = 12.0;
/// Mean reduction of a block over its standard error: one stretch of the log must not decide.
inline constexpr double least_block_t = 4.0;
/// rms torque of a term in units of the noise, below which it is there and does not matter.
inline constexpr double least_noise_share = 0.3;
/// Share of the squares still to be explained that a term must take: else it corrects the form of another.
inline constexpr double least_gap_share = 0.1;
/// Share of the first gap that a change of the ripple must take: the form of a large resonance is not exact.
inline constexpr double least_whole_share = 0.01;
/// Share of the whole gap above which a term is accepted although few blocks carry it, as those of a drift
/// do.
inline constexpr double dominant_gap_share = 0.4;
/// A plainer term is preferred if it reaches this share of the other's reduction.
inline constexpr double plain_delay_share = 0.985;
inline constexpr double plain_friction_share = 0.96;
inline constexpr double plain_ratio_share = 0.99;

/// Squares over those of the noise from which paths that begin with other terms compete.
inline constexpr double much_left = 1.5;
/// Part of the blocks, the best, without which a term of few stretches is judged; what it must reduce there;
/// and, per sample, what a friction with another must, and Stribeck friction, the usual correction of a
/// form.
inline constexpr double best_block_share = 0.15;
inline constexpr double least_spread = 100.0;
inline constexpr double form_spread = 0.015, stribeck_spread = 0.1;

}  // namespace ripplenotch::engine
