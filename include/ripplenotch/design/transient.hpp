// SPDX-License-Identifier: MIT
#pragma once
// Step and ramp figures of a cascade, measured on its own sampled response.

#include <span>

#include "ripplenotch/core/biquad.hpp"
#include "ripplenotch/core/units.hpp"

namespace ripplenotch {

struct StepFigures {
    Seconds settle;               ///< time after which the step response stays within the band
    double overshoot_percent = 0.0;
};

/// Response to a unit step at t = 0 from rest, run until it has surely settled.
[[nodiscard]] StepFigures measure_step(std::span<const Biquad> cascade, Hertz sample_rate, double band_percent);

}  // namespace ripplenotch
