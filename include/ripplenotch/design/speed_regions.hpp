// SPDX-License-Identifier: MIT
#pragma once
// What holds at which speed: the bands of a table, and the rules for what lies below, between and above them.

#include <span>
#include <utility>
#include <vector>

#include "ripplenotch/core/units.hpp"
#include "ripplenotch/design/candidate_table.hpp"

namespace ripplenotch {

/// In force when no candidate is: the torque passes.
inline constexpr int no_candidate = -1;

/// A range of speed in which one rule holds: from < |v| <= to.
struct SpeedRegion {
    double from_deg_s = 0.0, to_deg_s = 0.0;
    int candidate = no_candidate;  ///< index into the table's bands; no_candidate
    bool holds = false;            ///< the candidate in force stays, whichever it is
    /// Share of the filtered signal in the output: 1 but where the rule fades. It falls linearly from 1 at
    /// full_deg_s to 0 at none_deg_s and stays 0 beyond; both equal means 1 everywhere.
    double full_deg_s = 0.0, none_deg_s = 0.0;

    [[nodiscard]] double share(double speed_deg_s) const noexcept;
    [[nodiscard]] bool fades() const noexcept { return full_deg_s != none_deg_s; }
};

/// All speeds from 0 up, without holes. `fade` reaches from the edge of a band to half that speed below the
/// first band, to one and a half times that speed above the last, and to the middle of a hole.
[[nodiscard]] std::vector<SpeedRegion> speed_regions(std::span<const std::pair<DegPerSec, DegPerSec>> bands,
                                                     OutsideRule below, OutsideRule above);
[[nodiscard]] std::vector<SpeedRegion> speed_regions(std::span<const Band> bands, OutsideRule below,
                                                     OutsideRule above);

}  // namespace ripplenotch
