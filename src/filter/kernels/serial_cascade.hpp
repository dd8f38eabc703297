// SPDX-License-Identifier: MIT
#pragma once
// Sections in series, sample by sample: the arithmetic that every faster form is measured against.

#include <span>

#include "ripplenotch/core/biquad.hpp"

namespace ripplenotch {

/// Filters `values` in place by step(), section after section. `states` has one entry a section.
void run_serial(std::span<const Biquad> sections, std::span<BiquadState> states, std::span<double> values);

}  // namespace ripplenotch
