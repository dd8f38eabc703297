// SPDX-License-Identifier: MIT
#pragma once
// The diagnosis of one joint of a log, from its columns to its improved model.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/options/joint_runs.hpp"
#include "ripplenotch/arm/arm_setup.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/document/results.hpp"
#include "ripplenotch/export/joint_mjcf.hpp"
#include "ripplenotch/model/motion.hpp"
#include "ripplenotch/verdict/given_terms.hpp"

namespace ripplenotch {

// What was asked of diagnose.

/// Its gear is a ratio alone, in place of a model.
struct DiagnoseRequest : LogRequest {
    std::string model;
    std::optional<std::string> improved;  ///< file of the improved model
    bool improved_by_output = false;      ///< which was named by -o
    GivenOptions given;
    std::optional<std::string> drive;  ///< the control law by which the torque is made
    std::optional<std::string> validate;
    std::vector<std::string> without, accept;
    bool explain = false;
    bool effects = false;               ///< list the catalogue, and end
    std::optional<std::string> effect;  ///< explain this one of it, and end
    Seconds smoothing = default_smoothing;
    bool require_conclusive = false;
    bool friction_table = false;  ///< the log is said to be one

    [[nodiscard]] bool all_joints() const { return asks_for_several(path, log); }
};

/// Throws UsageError, before anything is read.
void check(const DiagnoseRequest& request);
/// The file of --improved-model, of which names may end so.
void check_improved(const DiagnoseRequest& request, std::string_view endings);

struct JointDiagnosis {
    std::string joint;  ///< empty where the log names none
    GearAccount gear;
    GivenTerms given;
    Log log;
    Diagnosis diagnosis;
    Provenance provenance;
    std::optional<MjcfAccount> mjcf = {};  ///< what the improved model was written as, if MuJoCo's

    [[nodiscard]] bool is_conclusive() const;
    /// What its document says; it is borrowed.
    [[nodiscard]] DiagnosedJoint facts() const {
        return {joint, diagnosis, gear, given.account ? &*given.account : nullptr, mjcf ? &*mjcf : nullptr};
    }
};

/// Reads and diagnoses one joint: that of the request, or `joint` of all. `given`: what all joints share.
/// Throws UsageError, DataError, FileError.
[[nodiscard]] JointDiagnosis diagnosed_joint(const DiagnoseRequest& request,
                                             const std::optional<std::string>& joint, GivenSource& given,
                                             const std::string& command_line);

/// The joints of the log that can be diagnosed, in its order: with torque, and with an arm of --arm those of
/// its chain; the others are told.
[[nodiscard]] std::vector<std::string> joints_of(const DiagnoseRequest& request, GivenSource& given);

// --improved-model joint.xml: the improved model in the words of MuJoCo, as far as it has words for it.

/// Names that end in .xml or .mjcf.
[[nodiscard]] bool names_mjcf(std::string_view path);

/// Its text, for a file of this name: a joint of its own or, with --arm mjcf,file=..., that file with the
/// joint's friction and motors in it. What it holds goes to `one`. Throws what write_into_mjcf throws.
[[nodiscard]] std::string improved_mjcf(const DiagnoseRequest& request, JointDiagnosis& one,
                                        const std::string& path);

/// What was held and what was not, a line each.
[[nodiscard]] std::string mjcf_text(const MjcfAccount& account);

// A diagnosis as a story for people.

// The end of the story: what was accepted, where the gap is, what to do next; and numbers as a story has
// them.

/// Four digits.
[[nodiscard]] std::string short_number(double value);

/// "torque_nm = 0.8 [0.7, 0.9]"
[[nodiscard]] std::string value_text(const Term& term, const FittedValue& value);

/// `explain`: all findings in full, and why each refused candidate was not named.
[[nodiscard]] std::string diagnosis_story(const CommonOptions& common, const Diagnosis& diagnosis,
                                          bool explain = false);

/// "arm: 6 joints of ur10.urdf matched by number (-v shows them); 36 of 36 combinations ... 0.1 s", and what
/// it leaves.
[[nodiscard]] std::string arm_text(const ArmAccount& account);

// diagnose of a table of constant speeds and friction torques.

/// The rows of the request's log where it is a table and no log: --friction-table says so, or it has speed
/// and torque, no time, no position and no stated rate, and fewer rows than a log must have. Empty for a log.
/// Throws DataError where such a file has as many rows as a log, and nothing says which of both it is; for a
/// table what the readers throw, and UsageError for options that a table has no use for.
[[nodiscard]] std::optional<Log> friction_table_of(const DiagnoseRequest& request);

/// Fits it.
[[nodiscard]] Answer run_friction_table(const DiagnoseRequest& request, const Log& table,
                                        const std::string& command_line);

}  // namespace ripplenotch
