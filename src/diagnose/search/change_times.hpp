// SPDX-License-Identifier: MIT
#pragma once
// When inertia and gravity change within a log: where the search for a payload that is picked up or put down
// begins.

#include <vector>

#include "diagnose/case/case.hpp"
#include "ripplenotch/diagnose/rules.hpp"

namespace ripplenotch {

struct ChangeTimes {
    std::vector<double> times_s;  ///< from the first sample, the likeliest first; none in a short log
    double compared = 1.0;        ///< number of times that were compared
};

/// The times at which a change of inertia and gravity reduces the sum of squares of the residual most, each
/// by least squares beside a constant inertia, gravity and offset.
[[nodiscard]] ChangeTimes change_times(const Case& looked_at, const std::vector<double>& residual_nm,
                                       double noise_nm, const DiagnosisRules& rules);

}  // namespace ripplenotch
