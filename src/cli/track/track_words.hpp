// SPDX-License-Identifier: MIT
#pragma once
// What `track` says of rows that it could not measure.

#include <string>
#include <vector>

#include "ripplenotch/analysis/track_report.hpp"

namespace ripplenotch {

[[nodiscard]] std::vector<std::string> track_warnings(const TrackReport& report);

/// Why no row at all could be measured.
[[nodiscard]] std::string why_nothing_tracked(const TrackReport& report);

}  // namespace ripplenotch
