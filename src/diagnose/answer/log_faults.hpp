// SPDX-License-Identifier: MIT
#pragma once
// Faults of the converter, seen in the logged torque itself: no model of the joint is needed for them.

#include <span>
#include <vector>

#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/model/motion.hpp"

namespace ripplenotch {

/// In the order of their detectors. Rows that they spoiled become 0 in `use`.
[[nodiscard]] std::vector<Fault> find_faults(const Motion& motion, std::span<const double> torque_nm,
                                             std::vector<unsigned char>& use);

}  // namespace ripplenotch
