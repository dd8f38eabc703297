// SPDX-License-Identifier: MIT
#pragma once
// Sections in series, sample by sample: the arithmetic that every faster form is measured against.

#include <span>

#include "ripplenotch/core/biquad.hpp"

namespace ripplenotch {

/// out = origin + F(in - origin) by step(), section after section. `states` has one entry a section; `in` may
/// be `out`.
void run_serial(std::span<const Biquad> sections, std::span<BiquadState> states, std::span<const double> in,
                double origin, std::span<double> out);

}  // namespace ripplenotch
