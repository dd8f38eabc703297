// SPDX-License-Identifier: MIT
#pragma once
// Tables from their requirements: a worst attenuation, a longest delay, or both. Bands and Q follow.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/design/candidate_table.hpp"

namespace ripplenotch {

/// Requirements for a table. At least one of attenuation and delay; values that are not stated are chosen.
struct DesignGoal {
    /// Of each order, at every speed of every band: Band::least_attenuation_db.
    std::optional<double> min_attenuation_db;
    /// Instead: of the ripple of all orders together, by TableSpec::amplitude_nm.
    std::optional<double> min_ripple_reduction_db;
    std::optional<Seconds> max_delay;  ///< DC group delay of every band
    std::optional<double> q;           ///< Q of all notches; else each band and order gets its own
    std::optional<int> most_bands;     ///< at least 1
    DegPerSec from, to;                ///< speeds to cover, when TableSpec::bands is empty

    [[nodiscard]] bool together() const { return min_ripple_reduction_db.has_value(); }
    [[nodiscard]] std::optional<double> attenuation_db() const {
        return together() ? min_ripple_reduction_db : min_attenuation_db;
    }
};

/// A table and why it is this one of those that hold the goal: a clause, "because ..." left out.
struct DesignChoice {
    CandidateTable table;
    std::string reason;
    /// Delay for which the Qs were chosen; 0 when they were stated or fixed bands left no choice.
    Seconds delay;
};

/// Finds the table. With TableSpec::bands empty the bands are as few as hold the attenuation, each as wide as
/// the worst speed and gear ratio in it allow, and within the delay (without one: that of the notches which
/// settle soonest at the lowest speed). With a delay alone they are as many as still add a quarter of a
/// decibel each, or most_bands. With TableSpec::bands the Qs alone are chosen. With amplitudes the orders
/// count by them. Throws UsageError on a goal that makes no sense and Error with ExitCode::limit_violated,
/// naming the limit and what would hold, when no table can.
[[nodiscard]] DesignChoice design_for(TableSpec spec, const DesignGoal& goal);

/// The lowest speed at which notches for these orders, as narrow as a design may take them (Q 5), delay by no
/// more than `delay`; empty when they do not at any speed below half the sample rate.
[[nodiscard]] std::optional<DegPerSec> slowest_within(const TableSpec& spec, Seconds delay);

// The trade-off of a designed table as a curve: attenuation against delay, or either against the number of
// bands.

/// Figures of one whole table, each that of its worst band.
struct TradePoint {
    std::size_t bands = 0;
    double attenuation_db = 0.0;  ///< held everywhere
    Seconds delay;                ///< DC group delay
    double least_q = 0.0, largest_q = 0.0;
    Seconds settle;
    double overshoot_percent = 0.0;
};

/// Along a frontier no point is better than another in both of the traded figures.
struct Frontier {
    TableSpec spec;  ///< without bands
    DesignGoal goal;
    std::vector<TradePoint> points;
    std::size_t recommended = 0;       ///< index; the table that design_for gives for the same goal
    std::string reason;                ///< why it: a clause
    std::optional<DegPerSec> slowest;  ///< lower speed limit of the recommended delay: see slowest_within
};

inline constexpr int frontier_bands = 32;  ///< most_bands where only attenuation and delay are traded

/// With neither attenuation nor delay in `goal`: attenuation against delay, with at most goal.most_bands
/// (frontier_bands) bands. With an attenuation: bands against delay. With a delay: bands against attenuation.
/// With both: bands against delay, within it. Throws as design_for does; goal.q and TableSpec::bands are
/// refused.
[[nodiscard]] Frontier design_frontier(TableSpec spec, DesignGoal goal);

}  // namespace ripplenotch
