// SPDX-License-Identifier: MIT
#pragma once
// -o improved.xml: the improved model in the words of MuJoCo, as far as it has words for it.

#include <string>
#include <string_view>

#include "cli/diagnose/joint_diagnosis.hpp"
#include "ripplenotch/export/joint_mjcf.hpp"

namespace ripplenotch {

/// Names that end in .xml or .mjcf.
[[nodiscard]] bool names_mjcf(std::string_view path);

/// Writes it to `path`: a joint of its own or, with --arm mjcf,file=..., that file with the joint's friction
/// and motors in it. Throws what write_into_mjcf and write_text throw.
[[nodiscard]] MjcfAccount write_improved_mjcf(const DiagnoseRequest& request, const JointDiagnosis& one,
                                              const std::string& path);

/// What was held and what was not, a line each.
[[nodiscard]] std::string mjcf_text(const MjcfAccount& account);

}  // namespace ripplenotch
