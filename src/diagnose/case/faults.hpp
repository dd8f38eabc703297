// SPDX-License-Identifier: MIT
#pragma once
// Faults of the converter, seen in the logged torque itself: no model of the joint is needed for them.
// Samples that they spoiled do not count in anything that follows.

#include <vector>

#include "diagnose/case/case.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {

/// Marks spoiled samples in `looked_at.use`.
[[nodiscard]] std::vector<Fault> find_faults(Case& looked_at, const FaultRules& rules);

}  // namespace ripplenotch
