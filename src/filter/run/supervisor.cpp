// SPDX-License-Identifier: MIT
#include "ripplenotch/filter/supervisor.hpp"

#include <algorithm>
#include <cmath>

#include "core/rows/first_outside.hpp"

namespace ripplenotch {

Supervisor::Supervisor(std::span<const Band> bands, const SupervisorSettings& settings)
    : regions_(speed_regions(bands, settings.below, settings.above)),
      hysteresis_deg_s_(settings.hysteresis.value()),
      dwell_(settings.dwell_samples) {}

std::size_t Supervisor::find(double speed_deg_s) const noexcept {
    const auto holds_speed = [speed_deg_s](const SpeedRegion& region) {
        return speed_deg_s <= region.to_deg_s;
    };
    const auto found = std::find_if(regions_.begin(), regions_.end(), holds_speed);
    // A speed that is not a number is in no region; the lowest is the one that does least.
    return found == regions_.end() ? 0 : static_cast<std::size_t>(found - regions_.begin());
}

int Supervisor::candidate_in(const SpeedRegion& region) const noexcept {
    return region.holds ? candidate_ : region.candidate;
}

void Supervisor::enter(std::size_t region) noexcept {
    at_ = region;
    low_ = regions_[at_].from_deg_s - hysteresis_deg_s_;
    high_ = regions_[at_].to_deg_s + hysteresis_deg_s_;
}

void Supervisor::start(double velocity_deg_s) noexcept {
    candidate_ = no_candidate;
    enter(find(std::abs(velocity_deg_s)));
    candidate_ = candidate_in(region());
    since_switch_ = dwell_;  // the first choice is no switch: it need not dwell
}

std::size_t Supervisor::stay(std::span<const double> velocity_deg_s) noexcept {
    std::size_t count = 0;
    while (true) {
        count += first_outside(velocity_deg_s.subspan(count), low_, high_);
        if (count == velocity_deg_s.size()) break;
        const bool must_dwell = since_switch_ + count < dwell_;
        const SpeedRegion& next = regions_[find(std::abs(velocity_deg_s[count]))];
        if (!must_dwell || candidate_in(next) == candidate_) break;
        ++count;
    }
    since_switch_ = std::min(since_switch_ + count, dwell_);
    return count;
}

bool Supervisor::move(double velocity_deg_s) noexcept {
    const std::size_t next = find(std::abs(velocity_deg_s));
    const int before = candidate_;
    candidate_ = candidate_in(regions_[next]);
    enter(next);
    if (candidate_ != before) {
        since_switch_ = std::min<std::size_t>(1, dwell_);
    } else {
        since_switch_ = std::min(since_switch_ + 1, dwell_);
    }
    return candidate_ != before;
}

}  // namespace ripplenotch
