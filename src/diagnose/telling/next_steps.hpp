// SPDX-License-Identifier: MIT
#pragma once
// What a user can do about what a diagnosis leaves in doubt: the motion that would decide, and the word that
// takes a finding into the model all the same.

#include <string>
#include <vector>

#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {

/// A sentence each; nothing where nothing is in doubt. `smoothed` is the log's motion.
[[nodiscard]] std::vector<std::string> next_steps(const Diagnosis& diagnosis, const Motion& smoothed,
                                                  const DiagnosisRules& rules);

}  // namespace ripplenotch
