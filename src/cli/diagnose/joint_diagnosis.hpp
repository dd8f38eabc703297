// SPDX-License-Identifier: MIT
#pragma once
// The diagnosis of one joint of a log, from its columns to its improved model.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/options/joint_runs.hpp"
#include "cli/options/plot_request.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/export/joint_mjcf.hpp"
#include "ripplenotch/model/model.hpp"
#include "ripplenotch/model/motion.hpp"
#include "ripplenotch/verdict/gear_choice.hpp"
#include "ripplenotch/verdict/given_terms.hpp"

namespace ripplenotch {

// What was asked of diagnose.

struct DiagnoseRequest {
    CommonOptions common;
    PlotRequest plot;
    ReadOptions log;
    std::string path, model;
    std::optional<std::string> improved;  ///< file of the improved model
    bool improved_by_output = false;      ///< which was named by -o
    GearOptions gear;                     ///< a ratio alone, in place of a model
    GivenOptions given;
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

/// Writes it to `path`: a joint of its own or, with --arm mjcf,file=..., that file with the joint's friction
/// and motors in it. Throws what write_into_mjcf and write_text throw.
[[nodiscard]] MjcfAccount write_improved_mjcf(const DiagnoseRequest& request, const JointDiagnosis& one,
                                              const std::string& path);

/// What was held and what was not, a line each.
[[nodiscard]] std::string mjcf_text(const MjcfAccount& account);

}  // namespace ripplenotch
