// SPDX-License-Identifier: MIT
#pragma once
// --plan FILE --limits ...: the motion that would decide what a log left open, as a file of positions.

#include <string>

#include "cli/diagnose/joint_diagnosis.hpp"
#include "ripplenotch/diagnose/plan.hpp"

namespace ripplenotch {

/// Throws UsageError: --plan without --limits or the other way round, limits that are none, beside an arm or
/// a simulation, whose torque along a motion that nobody has made is not known.
void check_plan(const DiagnoseRequest& request);

/// Plans for one joint and writes its rows of time, position and velocity, where something is open.
[[nodiscard]] PlannedMotion plan_for(const DiagnoseRequest& request, const JointDiagnosis& one);

/// What it would tell, a line each.
[[nodiscard]] std::string plan_text(const PlannedMotion& planned);

}  // namespace ripplenotch
