// SPDX-License-Identifier: MIT
#pragma once
// What was asked of diagnose.

#include <optional>
#include <string>
#include <vector>

#include "cli/gear/gear_choice.hpp"
#include "cli/given/given_terms.hpp"
#include "cli/options/plot_request.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/model/motion.hpp"

namespace ripplenotch {

struct DiagnoseRequest {
    CommonOptions common;
    PlotRequest plot;
    LogOptions log;
    std::string path, model;
    GearOptions gear;  ///< a ratio alone, in place of a model
    GivenOptions given;
    std::optional<std::string> validate;
    std::optional<std::string> plan, limits;  ///< a file; "speed=90deg/s,acceleration=..."
    std::vector<std::string> without, rules, accept;
    bool list_rules = false, explain = false;
    Seconds smoothing = default_smoothing;
    bool require_conclusive = false;

    [[nodiscard]] bool all_joints() const { return log.joint && *log.joint == "all"; }
};

/// Throws UsageError, before anything is read.
void check(const DiagnoseRequest& request);
[[nodiscard]] DiagnosisRules rules_of(const DiagnoseRequest& request);

}  // namespace ripplenotch
