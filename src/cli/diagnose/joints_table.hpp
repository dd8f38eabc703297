// SPDX-License-Identifier: MIT
#pragma once
// The diagnoses of all joints in one table.

#include <string>
#include <vector>

#include "cli/diagnose/joint_diagnosis.hpp"

namespace ripplenotch {

/// A row a joint: rms before and after, on the validation log where there is one, and what is named.
[[nodiscard]] std::string joints_table(const std::vector<JointDiagnosis>& joints);

}  // namespace ripplenotch
