// SPDX-License-Identifier: MIT
#pragma once
// The spectrum in which lines of a residual are looked for: of samples at any places, of time or of angle.

#include <cstddef>
#include <vector>

#include "ripplenotch/diagnose/rules.hpp"

namespace ripplenotch {

using LineRules = DiagnosisRules::LineRules;

/// Values in Nm at places in s or in deg.
struct Samples {
    std::vector<double> where, value;
};

/// Cell k is at k * spacing, in cycles per unit of the places.
struct Spectrum {
    double spacing = 0.0;
    std::vector<double> power;  ///< squared amplitude, Nm^2
};

/// From the first place to the last one; never 0.
[[nodiscard]] double range_of(const Samples& samples);

[[nodiscard]] Spectrum spectrum_of(const Samples& samples, double spacing, std::size_t count);
/// As finely spaced as the range of the samples tells, up to `highest` or as many cells as the rules allow.
[[nodiscard]] Spectrum spectrum_of(const Samples& samples, double highest, const LineRules& rules);

}  // namespace ripplenotch
