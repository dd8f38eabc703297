// SPDX-License-Identifier: MIT
#pragma once
// The joint model that a command is given: a file, options, or a file with options on top.

#include <optional>
#include <string>
#include <vector>

#include "cli/gear/gear_choice.hpp"
#include "cli/options/options.hpp"
#include "ripplenotch/document/model_json.hpp"

namespace ripplenotch {

/// --model, --gear-ratio, --inertia, --ripple, --effect.
struct JointModelOptions {
    std::optional<std::string> model;
    GearOptions gear;  ///< a ratio alone
    std::optional<double> inertia_kgm2;
    std::vector<std::string> ripples, effects;
};
void attach_joint_model(Options& options, JointModelOptions& joint);

/// With what is given beside the effects; only a command that has a log knows what to do with that, and
/// `takes_given` says so: otherwise it is refused. Throws UsageError, DataError, FileError.
[[nodiscard]] ModelWithGiven assemble_model(const JointModelOptions& joint, bool takes_given);

/// The gear of the assembled model, with what was typed or read as its source.
[[nodiscard]] GearAccount assembled_gear(const JointModelOptions& joint, const Model& model);

}  // namespace ripplenotch
