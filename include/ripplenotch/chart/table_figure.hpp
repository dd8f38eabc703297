// SPDX-License-Identifier: MIT
#pragma once
// Figures of designs: the candidate table over speed, and attenuation against delay.

#include <span>
#include <string>

#include "ripplenotch/design/candidate_table.hpp"
#include "ripplenotch/figure/figure.hpp"

namespace ripplenotch {

/// The centres of every band over the speed beside the ripple that they are for (Kim, Kim, Song 2011, fig.
/// 4), the worst attenuation in each band, and its delay and settling time.
[[nodiscard]] Figure table_figure(const CandidateTable& table);

/// One design of a frontier.
struct FrontierPoint {
    double delay_ms = 0.0, attenuation_db = 0.0;
    bool chosen = false;
    std::string name;  ///< of a rival that is shown beside the frontier; empty on the frontier itself
};

/// Attenuation against delay, the designs on the frontier joined in the order of their delay.
[[nodiscard]] Figure frontier_figure(const std::string& title, const std::string& sentence,
                                     std::span<const FrontierPoint> points);

}  // namespace ripplenotch
