// SPDX-License-Identifier: MIT
#pragma once
// Is a band of a power spectrum a hump, wider than a line and above the noise to both its sides, or could
// noise have made it? Beside line_test.hpp, which asks the same of single peaks.

#include <cstddef>
#include <vector>

#include "ripplenotch/analysis/line_test.hpp"

namespace ripplenotch {

/// Bins [first, end) that carry more than the noise beside them.
struct SignificantHump {
    std::size_t first = 0, end = 0;
    double floor = 0.0;        ///< mean noise power beside it: the largest of left, right and around
    double false_alarm = 1.0;  ///< chance that noise gives such a hump anywhere in the spectrum
};

/// Humps whose false_alarm is at most the one asked for, in bin order, not overlapping. A band from 2.5 cells
/// up to a fifth of the spectrum is compared with the noise below it, above it and around it, whichever is
/// largest: noise that falls or rises along the bins, of whatever colour, is higher on one side and so makes
/// no hump. The ratio follows an F distribution; where neighbouring cells are alike, as in noise that comes
/// in bursts, as many fewer of them count. What has less than twice the amplitude of
/// the noise beside it is none, since a person would overlook it. Take lines out of the power first: they
/// would be humps. O(n log n).
[[nodiscard]] std::vector<SignificantHump> significant_humps(const PowerSpectrum& spectrum,
                                                             double false_alarm);

}  // namespace ripplenotch
