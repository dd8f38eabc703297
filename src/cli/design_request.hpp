// SPDX-License-Identifier: MIT
#pragma once
// What the design command was asked for, and the table specification that follows from it and a joint.json.

#include <optional>
#include <string>
#include <vector>

#include "cli/joint_facts.hpp"
#include "cli/options.hpp"
#include "cli/plot_request.hpp"
#include "ripplenotch/design/guarantee.hpp"

namespace ripplenotch {

struct DesignRequest {
    CommonOptions common;
    PlotRequest plot;
    std::string joint;
    std::optional<double> gear_ratio, ratio_error_percent, depth_db, max_delay_ms, min_attenuation_db, q;
    std::optional<double> goal_attenuation_db, max_bands;
    std::optional<Seconds> goal_delay;
    std::vector<double> orders, amplitudes_nm;
    std::optional<Hertz> sample_rate, spacing;
    std::optional<std::string> speed, bands;
    double settle_band_percent = 0.5;
    std::string width = "analog", below = "pass", above = "hold", form;
    bool frontier = false;

    /// Something is left to the tool: it chooses bands, Q, or both.
    [[nodiscard]] bool has_goal() const { return goal_attenuation_db || goal_delay || frontier; }
};

/// Options first, then the joint file. Without bands when they are left to a goal. Throws UsageError that
/// names the option which is missing or wrong.
[[nodiscard]] TableSpec design_spec(const DesignRequest& request, const std::optional<JointFacts>& joint);

/// The goal, with the speeds to cover where `spec` has no bands.
[[nodiscard]] DesignGoal design_goal(const DesignRequest& request, const TableSpec& spec,
                                     const std::optional<JointFacts>& joint);

}  // namespace ripplenotch
