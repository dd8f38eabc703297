// SPDX-License-Identifier: MIT
#pragma once
// What the design command was asked for, and the table specification that follows from it and a joint.json.

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "cli/gear/gear_choice.hpp"
#include "cli/options/options.hpp"
#include "cli/options/plot_request.hpp"
#include "ripplenotch/design/guarantee.hpp"

namespace ripplenotch {

struct DesignRequest {
    CommonOptions common;
    PlotRequest plot;
    std::string joint;
    GearOptions gear;
    std::optional<double> ratio_error_percent, depth_db, q, max_bands;
    std::optional<double> min_attenuation_db;  ///< a goal, and only a check where bands and Q are stated
    std::optional<Seconds> max_delay;          ///< the same
    std::vector<double> amplitudes_nm;
    std::optional<Hertz> sample_rate, spacing;
    std::optional<std::string> speed, bands;
    double settle_band_percent = 0.5;
    std::string width = "analog", below = "pass", above = "hold", form;
    bool frontier = false;

    /// Something is left to the tool: it chooses bands, Q, or both.
    [[nodiscard]] bool has_goal() const {
        return frontier || ((min_attenuation_db || max_delay) && !only_checks());
    }
    /// Limits are what the stated table is held against.
    [[nodiscard]] bool only_checks() const {
        const bool widths = speed && std::count(speed->begin(), speed->end(), ':') > 1;
        return q && (bands || spacing || widths) && !frontier;
    }
};

/// Without bands when they are left to a goal. Throws what GearChoice::of throws, and UsageError that names
/// the option which is missing or wrong.
[[nodiscard]] TableSpec design_spec(const DesignRequest& request, const GearChoice& gear);

/// The goal, with the speeds to cover where `spec` has no bands.
[[nodiscard]] DesignGoal design_goal(const DesignRequest& request, const TableSpec& spec,
                                     const GearChoice& gear);

}  // namespace ripplenotch
