// SPDX-License-Identifier: MIT
#include "log/held_samples.hpp"

#include <algorithm>
#include <cmath>

namespace ripplenotch {
namespace {

constexpr std::size_t fewest_changes = 8;

}  // namespace

void HeldCounter::Way::add(bool same) {
    run = same ? run + 1 : 0;
    held.count += same;
    held.longest = std::max(held.longest, run);
}

bool HeldCounter::moves(const Row& row, const Row& before) const {
    return std::min(std::abs(row.velocity), std::abs(before.velocity)) > moving_deg_s_;
}

void HeldCounter::take(const Row& row) {
    const bool moving = moves(row, before_), torque = moving && row.torque == before_.torque;
    const bool velocity = row.velocity == before_.velocity;
    const bool position = has_position_ && row.position == before_.position;
    if (moving) {
        ++moving_rows_;
        velocity_repeats_ += velocity;
        position_repeats_ += position;
        const double change = std::abs(row.torque - before_.torque);
        if (change > 0.0) {
            ++changes_;
            smallest_change_ = std::min(smallest_change_, change);
        }
    }
    ways_[0].add(torque);
    ways_[1].add(torque && velocity);
    ways_[2].add(torque && position);
    ways_[3].add(torque && velocity && position);
}

void HeldCounter::take(const TraceView& rows) {
    has_position_ = rows.has_position();
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Row row{rows.velocity_deg_s[i], rows.torque_nm[i],
                      has_position_ ? rows.position_deg[i] : Row().position};
        if (rows_++ > 0)
            take(row);
        else
            usable_ = std::isfinite(row.torque) && std::isfinite(row.velocity);
        before_ = row;
    }
}

const HeldCounter::Way& HeldCounter::way() const {
    return ways_[(velocity_tells() ? 1U : 0U) + (position_tells() ? 2U : 0U)];
}

bool HeldCounter::needs_grain() const {
    return usable_ && !velocity_tells() && !position_tells() && way().held.count > 0 &&
           changes_ >= fewest_changes;
}

void HeldCounter::take_grain(const TraceView& rows) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Row row{rows.velocity_deg_s[i], rows.torque_nm[i]};
        if (grain_rows_++ > 0 && moves(row, grain_before_)) {
            const double change = std::abs(row.torque - grain_before_.torque);
            fine_changes_ += change > 0.0 && change < 10.0 * smallest_change_;
        }
        grain_before_ = row;
    }
}

// Steps of the torque are coarse when the usual change is only a few of the smallest: then equality is
// chance.
HeldSamples HeldCounter::held() const {
    if (!usable_) return {};
    const bool told = velocity_tells() || position_tells();
    const bool coarse = changes_ < fewest_changes || fine_changes_ > changes_ / 2;  // the median is below
    return told || !coarse ? way().held : HeldSamples{};
}

HeldSamples count_held(const TraceView& trace) {
    double fastest = 0.0;
    for (const double speed : trace.velocity_deg_s) fastest = std::max(fastest, std::abs(speed));
    HeldCounter counter(fastest);
    counter.take(trace);
    if (counter.needs_grain()) counter.take_grain(trace);
    return counter.held();
}

}  // namespace ripplenotch
