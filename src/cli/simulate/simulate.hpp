// SPDX-License-Identifier: MIT
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "cli/options/options.hpp"
#include "ripplenotch/document/model_json.hpp"
#include "ripplenotch/verdict/gear_choice.hpp"

namespace ripplenotch {

// The joint model that a command is given: a file, options, or a file with options on top.

/// --model, --gear-ratio, --inertia, --ripple, --effect.
struct JointModelOptions {
    std::optional<std::string> model;
    GearOptions gear;  ///< a ratio alone
    std::optional<double> inertia_kgm2;
    std::vector<std::string> ripples, effects;
};

/// With what is given beside the effects; only a command that has a log knows what to do with that, and
/// `takes_given` says so: otherwise it is refused. Throws UsageError, DataError, FileError.
[[nodiscard]] ModelWithGiven assemble_model(const JointModelOptions& joint, bool takes_given);

}  // namespace ripplenotch
