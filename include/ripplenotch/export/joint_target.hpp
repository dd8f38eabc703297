// SPDX-License-Identifier: MIT
#pragma once
// An export target of a joint model is a record in src/export/joint/joint_targets.cpp, and a row of
// docs/export/joints.md.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/export/joint_mjcf.hpp"
#include "ripplenotch/model/model.hpp"

namespace ripplenotch {

/// The file, and of each effect of the model where it is in it or why it is not.
struct WrittenJoint {
    std::string text;
    std::vector<MjcfPart> holds, not_held;
};

struct JointTarget {
    std::string_view name, summary, source;
    std::string_view endings;  ///< file name endings, separated by blanks
    std::span<const Key> keys = {};
    /// Every value of the model is stated. `heading` describes the origin of the file, one line each. Throws
    /// UsageError for values that the target cannot hold.
    WrittenJoint (*write)(const Model& model, const Settings& settings,
                          std::span<const std::string> heading) = nullptr;
};

[[nodiscard]] std::span<const JointTarget* const> joint_targets();
/// Throws UsageError with the nearest name.
[[nodiscard]] const JointTarget& find_joint_target(std::string_view name);

}  // namespace ripplenotch
