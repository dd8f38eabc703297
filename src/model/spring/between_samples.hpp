// SPDX-License-Identifier: MIT
#pragma once
// What a signal does between its samples, for delays that are not whole samples and for lags. A held value
// (zero-order hold) would put half a sample of delay into both; here the signal between samples is the
// polynomial through the nearest of them, centred, which delays nothing.

#include <array>
#include <span>
#include <vector>

namespace ripplenotch {

/// values(k) becomes values(k - delay), delay in samples, of either sign. The polynomial goes through 16
/// samples: a component of a fifth of the sample rate comes out with a relative error below 5e-5, one of
/// three tenths below 1e-2. Before the first sample and after the last, the signal is taken as constant.
void shift_samples(std::span<double> values, double delay);

/// The response of a first-order low-pass whose time constant is given in samples, above 0: the differential
/// equation solved exactly for the polynomial through 6 samples. It starts from the steady state of the first
/// value. A component of a tenth of the sample rate comes out with a relative error below 5e-4.
void first_order_lag(std::span<double> values, double time_constant);

/// Samples of the polynomial about a step between two of them.
inline constexpr int step_points = 6;  // by hand
using StepWeights = std::array<double, step_points>;
/// Weights of the samples at -2, ..., 3 from the beginning of a step for the integral over it of the
/// polynomial times anything; moments[m]: the integral of that times u^m, u from 0 to 1 along the step.
[[nodiscard]] StepWeights step_weights(const std::array<double, step_points>& moments);
/// Entry k: the integral over the step that ends at sample k. Before the first sample and after the last, the
/// signal is taken as constant.
[[nodiscard]] std::vector<double> over_steps(std::span<const double> values, const StepWeights& weights);

}  // namespace ripplenotch
