// SPDX-License-Identifier: MIT
#pragma once
// What track measured, as JSON.

#include <string>

#include "ripplenotch/analysis/track_report.hpp"
#include "ripplenotch/document/provenance.hpp"

namespace ripplenotch {

/// Schema ripplenotch/track/1; the columns are arrays, null where a line was not measured.
[[nodiscard]] std::string track_text(const TrackReport& report, const Provenance& provenance);

}  // namespace ripplenotch
