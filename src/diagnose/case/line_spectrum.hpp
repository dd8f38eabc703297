// SPDX-License-Identifier: MIT
#pragma once
// The spectrum in which lines of a residual are looked for: of samples at any places, of time or of angle.

#include <cstddef>
#include <vector>

#include "ripplenotch/diagnose/rules.hpp"

namespace ripplenotch {

using LineRules = DiagnosisRules::LineRules;

/// Values in Nm at places in s or in deg.
struct LineSamples {
    std::vector<double> where, value;
};

/// Cell k is at k * spacing, in cycles per unit of the places.
struct LineSpectrum {
    double spacing = 0.0;
    std::vector<double> power;  ///< squared amplitude, Nm^2
};

/// From the first place to the last one; never 0.
[[nodiscard]] double range_of(const LineSamples& samples);

[[nodiscard]] LineSpectrum spectrum_of(const LineSamples& samples, double spacing, std::size_t count);
/// As finely spaced as the range of the samples tells, up to `highest` or as many cells as the rules allow.
[[nodiscard]] LineSpectrum spectrum_of(const LineSamples& samples, double highest, const LineRules& rules);

}  // namespace ripplenotch
