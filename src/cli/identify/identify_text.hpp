// SPDX-License-Identifier: MIT
#pragma once
// An identification as people read it.

#include <string>
#include <vector>

#include "ripplenotch/analysis/identification.hpp"

namespace ripplenotch {

/// Verdict first, then ratio, lines, rivals, what the recordings disagree about, notes. `recordings` are
/// their names.
[[nodiscard]] std::string identification_report(const Identification& found,
                                                const std::vector<std::string>& recordings);

}  // namespace ripplenotch
