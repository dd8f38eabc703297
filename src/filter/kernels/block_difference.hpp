// SPDX-License-Identifier: MIT
#pragma once
// How far the block form is from the recursion, found out before the first sample.

#include <span>

#include "ripplenotch/core/biquad.hpp"

namespace ripplenotch {

/// Outputs may differ by this share of the largest |torque|, and no cascade whose trial comes near is
/// filtered in blocks.
inline constexpr double most_block_difference = 1e-12;
/// A log is longer than the trial, and may be worse.
inline constexpr double trial_reserve = 4.0;

/// The largest |block form - run_serial| on a trial: signals between -1 and 1 that are loud to a rounding
/// error, each for many time constants. Constants are the worst, for then every sample is rounded in the same
/// direction; then signs that turn when the impulse response does, and noise. Infinite for poles within a
/// thousandth of the circle, which are not tried.
[[nodiscard]] double trial_difference(std::span<const Biquad> sections);

/// There is a section, and trial_difference() with its reserve is within most_block_difference.
[[nodiscard]] bool block_form_serves(std::span<const Biquad> sections);

}  // namespace ripplenotch
