// SPDX-License-Identifier: MIT
#pragma once
// A recommendation as people read it.

#include <string>

#include "ripplenotch/document/recommendation_json.hpp"

namespace ripplenotch {

/// Verdict, commands to paste, what is in the log, all methods, and what was assumed.
[[nodiscard]] std::string recommendation_view(const RecommendationReport& report);

}  // namespace ripplenotch
