// SPDX-License-Identifier: MIT
#pragma once
// Looks through a log for info: every joint, the clock, steady stretches, and what all this is good for.

#include <string>

#include "ripplenotch/document/info_json.hpp"

namespace ripplenotch {

/// Reads the log, each joint of it unless one is chosen. Throws what reading throws; a log without torque,
/// velocity or time is described all the same.
[[nodiscard]] LogInfo survey_log(const std::string& path, ReadOptions options);

}  // namespace ripplenotch
