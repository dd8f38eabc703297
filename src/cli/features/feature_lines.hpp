// SPDX-License-Identifier: MIT
#pragma once
// All lines of one log; whatever is wrong with it is a line, too.

#include <vector>

#include "cli/features/feature_request.hpp"
#include "ripplenotch/fleet/feature_line.hpp"
#include "ripplenotch/fleet/shards.hpp"

namespace ripplenotch {

/// One line a joint of the log, in the log's order. Errors of the log are lines with an error; only what is
/// no matter of one log is thrown.
[[nodiscard]] std::vector<FeatureLine> feature_lines(const ManifestEntry& entry, const FeatureWork& work);

}  // namespace ripplenotch
