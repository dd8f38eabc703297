// SPDX-License-Identifier: MIT
#pragma once
// The supervisor of the switching filter: from the joint speed to the candidate that should be in force (Kim,
// Kim, Song 2011, fig. 3 and 4), with the rules for speeds that no band covers.

#include <cstddef>
#include <span>
#include <vector>

#include "ripplenotch/core/units.hpp"
#include "ripplenotch/design/candidate_table.hpp"

namespace ripplenotch {

/// In force when no candidate is: the torque passes.
inline constexpr int no_candidate = -1;

struct SupervisorSettings {
    OutsideRule below = OutsideRule::pass;  ///< below the first band, and in a hole between bands
    OutsideRule above = OutsideRule::hold;
    DegPerSec hysteresis{0.0};      ///< a region is left only when |v| is this far outside it; 0 as the paper
    std::size_t dwell_samples = 0;  ///< a candidate stays at least this long
};

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
[[nodiscard]] std::vector<SpeedRegion> speed_regions(std::span<const Band> bands, OutsideRule below,
                                                     OutsideRule above);

class Supervisor {
  public:
    /// Throws UsageError when the hysteresis is negative.
    Supervisor(std::span<const Band> bands, const SupervisorSettings& settings);

    /// The first sample of a run: takes the region of its speed, with no regard to the past.
    void start(double velocity_deg_s) noexcept;
    /// How many of these samples (after the one that was started or switched to) keep the candidate in force
    /// and the region; speeds.size() when all do. They are then accounted for.
    [[nodiscard]] std::size_t stay(std::span<const double> velocity_deg_s) noexcept;
    /// The sample at which stay() stopped: enters its region. True when the candidate changed.
    bool move(double velocity_deg_s) noexcept;

    [[nodiscard]] int candidate() const noexcept { return candidate_; }
    [[nodiscard]] const SpeedRegion& region() const noexcept { return regions_[at_]; }

  private:
    [[nodiscard]] std::size_t find(double speed_deg_s) const noexcept;
    [[nodiscard]] int candidate_in(const SpeedRegion& region) const noexcept;
    void enter(std::size_t region) noexcept;

    std::vector<SpeedRegion> regions_;
    double hysteresis_deg_s_;
    std::size_t dwell_;
    std::size_t since_switch_ = 0;
    std::size_t at_ = 0;
    double low_ = 0.0, high_ = 0.0;  ///< stay while low_ < |v| <= high_
    int candidate_ = no_candidate;
};

}  // namespace ripplenotch
