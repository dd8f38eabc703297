// SPDX-License-Identifier: MIT
#pragma once
// Step figures of a cascade, measured on its own sampled response.

#include <cstddef>
#include <span>

#include "ripplenotch/core/biquad.hpp"
#include "ripplenotch/core/units.hpp"

namespace ripplenotch {

struct StepFigures {
    Seconds settle;                  ///< time after which the step response stays within the band
    double overshoot_percent = 0.0;  ///< highest point above the final value; 0 when it never passes it
};

/// Response to a unit step at t = 0 from rest, run until it has surely settled. `band_percent` is half the
/// width of the band around the final value, 0 < band_percent < 100. Throws UsageError on an unstable cascade
/// or one that needs more than 5e7 samples.
[[nodiscard]] StepFigures measure_step(std::span<const Biquad> cascade, Hertz sample_rate,
                                       double band_percent);

/// Samples after which a step response has surely come within `remainder` (0 < remainder < 1) of its final
/// value. Throws UsageError on an unstable cascade or one that needs more than 5e7 samples.
[[nodiscard]] std::size_t samples_to_settle(std::span<const Biquad> cascade, double remainder);

}  // namespace ripplenotch
