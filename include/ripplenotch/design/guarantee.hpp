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
    std::optional<Seconds> max_delay;  ///< DC group delay of every band
    std::optional<double> q;           ///< Q of all notches; else each band gets its own
    DegPerSec from, to;                ///< speeds to cover, when TableSpec::bands is empty
};

/// A table and why it is this one of those that hold the goal: a clause, "because ..." left out.
struct DesignChoice {
    CandidateTable table;
    std::string reason;
};

/// Finds the table. With TableSpec::bands empty the bands are as few as hold the attenuation, each as wide as
/// the worst speed and gear ratio in it allow, and within the delay (without one: that of the notches which
/// settle soonest at the lowest speed). With a delay alone they are as many as still add a quarter of a
/// decibel each. With TableSpec::bands the Qs alone are chosen. Throws UsageError on a goal that makes no
/// sense and Error with ExitCode::limit_violated, naming the limit and what would hold, when no table can.
[[nodiscard]] DesignChoice design_for(TableSpec spec, const DesignGoal& goal);

/// The lowest speed at which notches for these orders, as narrow as a design may take them (Q 5), delay by no
/// more than `delay`; empty when they do not at any speed below half the sample rate.
[[nodiscard]] std::optional<DegPerSec> slowest_within(const TableSpec& spec, Seconds delay);
/// "Below 4.3 deg/s no notch of Q 5 or less is within 20 ms."
[[nodiscard]] std::string slowest_sentence(Seconds delay, DegPerSec slowest);

}  // namespace ripplenotch
