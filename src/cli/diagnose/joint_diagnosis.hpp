// SPDX-License-Identifier: MIT
#pragma once
// The diagnosis of one joint of a log, from its columns to its improved model.

#include "cli/diagnose/diagnose_request.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/diagnose/plan.hpp"
#include "ripplenotch/export/joint_mjcf.hpp"

namespace ripplenotch {

/// What --plan wrote.
struct PlannedMotion {
    std::string file;
    std::optional<MotionPlan> plan;  ///< none: nothing is open
};

struct JointDiagnosis {
    std::string joint;  ///< empty where the log names none
    GearAccount gear;
    GivenTerms given;
    Log log;
    Diagnosis diagnosis;
    Provenance provenance;
    std::optional<MjcfAccount> mjcf = {};  ///< what the improved model was written as, if MuJoCo's
    std::optional<PlannedMotion> planned = {};

    [[nodiscard]] bool is_conclusive() const;
};

/// Reads and diagnoses one joint: that of the request, or `joint` of all. `given`: what all joints share.
/// Throws UsageError, DataError, FileError.
[[nodiscard]] JointDiagnosis diagnosed_joint(const DiagnoseRequest& request,
                                             const std::optional<std::string>& joint, GivenSource& given,
                                             const std::string& command_line);

/// The joints of the log that can be diagnosed, in its order: with torque, and with an arm of --arm those of
/// its chain; the others are told.
[[nodiscard]] std::vector<std::string> joints_of(const DiagnoseRequest& request, GivenSource& given);

}  // namespace ripplenotch
