// SPDX-License-Identifier: MIT
#pragma once
// The supervisor of the switching filter: from the joint speed to the candidate that should be in force (Kim,
// Kim, Song 2011, fig. 3 and 4), with the rules for speeds that no band covers.

#include <cstddef>
#include <span>
#include <vector>

#include "ripplenotch/core/units.hpp"
#include "ripplenotch/design/candidate_table.hpp"
#include "ripplenotch/design/speed_regions.hpp"

namespace ripplenotch {

struct SupervisorSettings {
    OutsideRule below = OutsideRule::pass;  ///< below the first band, and in a hole between bands
    OutsideRule above = OutsideRule::hold;
    DegPerSec hysteresis{0.0};      ///< a region is left only when |v| is this far outside it; 0 as the paper
    std::size_t dwell_samples = 0;  ///< a candidate stays at least this long
};

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
