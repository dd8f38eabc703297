// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <vector>

#include "ripplenotch/evaluate/filter_metrics.hpp"

namespace ripplenotch {

// What filter says to people, on standard error.

/// Sentences worth a warning: gaps, a clock that changed, ripple that could not be measured.
[[nodiscard]] std::vector<std::string> filter_warnings(const FilterMetrics& metrics);

/// The metrics in a few lines, for -v.
[[nodiscard]] std::vector<std::string> filter_summary(const FilterMetrics& metrics);

}  // namespace ripplenotch
