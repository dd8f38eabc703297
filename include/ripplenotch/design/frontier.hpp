// SPDX-License-Identifier: MIT
#pragma once
// The trade-off of a designed table as a curve: attenuation against delay, or either against the number of
// bands.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "ripplenotch/design/guarantee.hpp"

namespace ripplenotch {

/// Figures of one whole table, each that of its worst band.
struct TradePoint {
    std::size_t bands = 0;
    double attenuation_db = 0.0;  ///< held everywhere
    Seconds delay;                ///< DC group delay
    double least_q = 0.0, largest_q = 0.0;
    Seconds settle;
    double overshoot_percent = 0.0;
};

/// Along a frontier no point is better than another in both of what it trades.
struct Frontier {
    TableSpec spec;  ///< without bands
    DesignGoal goal;
    std::vector<TradePoint> points;
    std::size_t recommended = 0;       ///< index; the table that design_for gives for the same goal
    std::string reason;                ///< why it: a clause
    std::optional<DegPerSec> slowest;  ///< of the recommended delay: see slowest_within
};

inline constexpr int frontier_bands = 32;  ///< most_bands where only attenuation and delay are traded

/// With neither attenuation nor delay in `goal`: attenuation against delay, with at most goal.most_bands
/// (frontier_bands) bands. With an attenuation: bands against delay. With a delay: bands against attenuation.
/// With both: bands against delay, within it. Throws as design_for does; goal.q and TableSpec::bands are
/// refused.
[[nodiscard]] Frontier design_frontier(TableSpec spec, DesignGoal goal);

}  // namespace ripplenotch
