// SPDX-License-Identifier: MIT
#pragma once
// The joint model that a command is given: a file, options, or a file with options on top.

#include <optional>
#include <string>
#include <vector>

#include "cli/gear/gear_choice.hpp"
#include "cli/options/options.hpp"
#include "ripplenotch/model/model.hpp"

namespace ripplenotch {

/// --model, --gear-ratio, --inertia, --ripple, --effect.
struct JointModelOptions {
    std::optional<std::string> model;
    GearOptions gear;  ///< a ratio alone
    std::optional<double> inertia_kgm2;
    std::vector<std::string> ripples, effects;
};
void attach_joint_model(Options& options, JointModelOptions& joint);

/// Throws UsageError, DataError, FileError.
[[nodiscard]] Model assemble_model(const JointModelOptions& joint);

/// The gear of the assembled model, with what was typed or read as its source.
[[nodiscard]] GearAccount assembled_gear(const JointModelOptions& joint, const Model& model);

}  // namespace ripplenotch
