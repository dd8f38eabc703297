// SPDX-License-Identifier: MIT
#pragma once
// What a log itself says against believing what identify finds in it.

#include <vector>

#include "ripplenotch/analysis/verdict.hpp"
#include "ripplenotch/log/log.hpp"

namespace ripplenotch {

/// One entry a reason, each with what settles it, with the log read in this way. Empty for a log that does
/// not contradict itself.
[[nodiscard]] std::vector<Doubt> log_doubts(const Log& log, const OtherReading& reading = {});

}  // namespace ripplenotch
