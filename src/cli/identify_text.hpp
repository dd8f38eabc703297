// SPDX-License-Identifier: MIT
#pragma once
// An identification as people read it.

#include <string>

#include "ripplenotch/analysis/identification.hpp"

namespace ripplenotch {

/// Verdict first, then ratio, lines, rivals, notes.
[[nodiscard]] std::string identification_report(const Identification& found);

}  // namespace ripplenotch
