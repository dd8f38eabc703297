// SPDX-License-Identifier: MIT
#pragma once
// What compare found, as JSON.

#include <string>
#include <vector>

#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/document/provenance.hpp"
#include "ripplenotch/evaluate/comparison.hpp"
#include "ripplenotch/evaluate/filter_metrics.hpp"
#include "ripplenotch/evaluate/recommendation.hpp"

namespace ripplenotch {

// metrics.json: what a filter did to one log.

/// The whole text of metrics.json, schema ripplenotch/metrics/1; same metrics, same bytes.
[[nodiscard]] std::string metrics_to_json(const FilterMetrics& metrics, const Provenance& provenance);

// What recommend found, as JSON.

/// A recommendation with the commands that make use of it.
struct RecommendationReport {
    Recommendation found;
    std::optional<GearAccount> gear;     ///< whose ripple it is about
    std::string target;                  ///< that the methods had to fit into; empty: none
    double split_s = 0.0;                ///< time up to which methods were trained, and from which on judged
    std::vector<std::string> take;       ///< command lines: what the method needs, the method, its export
    std::vector<std::string> runner_up;  ///< the same for the runner-up
    std::string check;                   ///< the command line that measures both again
    std::vector<std::string> assumed;    ///< one sentence each
    std::vector<std::string> left_out;   ///< methods that were not tried, and why, one sentence each
    bool conclusive = false;
};

/// The whole text; schema ripplenotch/recommendation/1. A figure that was not measured is null.
[[nodiscard]] std::string recommendation_text(const RecommendationReport& report,
                                              const Provenance& provenance);

/// The whole text; schema ripplenotch/comparison/1. A figure that was not measured is null.
[[nodiscard]] std::string comparison_text(const Comparison& comparison, const Provenance& provenance);

}  // namespace ripplenotch
