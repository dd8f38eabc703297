// SPDX-License-Identifier: MIT
#pragma once
// --plan FILE --limits ...: the motion that would decide what a log left open, as a file of positions.

#include <string>
#include <string_view>

#include "cli/diagnose/joint_diagnosis.hpp"
#include "ripplenotch/diagnose/plan.hpp"
#include "ripplenotch/export/joint_mjcf.hpp"

namespace ripplenotch {

// -o improved.xml: the improved model in the words of MuJoCo, as far as it has words for it.

/// Names that end in .xml or .mjcf.
[[nodiscard]] bool names_mjcf(std::string_view path);

/// Writes it to `path`: a joint of its own or, with --arm mjcf,file=..., that file with the joint's friction
/// and motors in it. Throws what write_into_mjcf and write_text throw.
[[nodiscard]] MjcfAccount write_improved_mjcf(const DiagnoseRequest& request, const JointDiagnosis& one,
                                              const std::string& path);

/// What was held and what was not, a line each.
[[nodiscard]] std::string mjcf_text(const MjcfAccount& account);

/// Throws UsageError: --plan without --limits or the other way round, limits that are none, beside an arm or
/// a simulation, whose torque along a motion that nobody has made is not known.
void check_plan(const DiagnoseRequest& request);

/// Plans for one joint and writes its rows of time, position and velocity, where something is open.
[[nodiscard]] PlannedMotion plan_for(const DiagnoseRequest& request, const JointDiagnosis& one);

/// What it would tell, a line each.
[[nodiscard]] std::string plan_text(const PlannedMotion& planned);

}  // namespace ripplenotch
