// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "ripplenotch/analysis/steady.hpp"

namespace ripplenotch {

void StretchMeter::add(const TraceView& rows) {
    if (rows.size() == 0) return;
    if (rows_ == 0) first_s_ = rows.time_s.front();
    last_s_ = rows.time_s.back();
    has_position_ = rows.has_position();
    for (std::size_t k = 0; k < rows.size(); ++k) {
        block_sum_ += rows.velocity_deg_s[k];
        const double speed = std::abs(rows.velocity_deg_s[k]);
        speeds_ += speed;
        squares_ += speed * speed;
        cubes_ += speed * speed * speed;
        // A stretch of fewer rows than blocks has empty ones.
        for (++rows_; block_ < blocks && rows_ >= end_of(block_); block_sum_ = 0.0) end_block();
        if (!has_position_) continue;
        const double t = rows.time_s[k] - mean_s_, p = rows.position_deg[k] - mean_position_deg_;
        tt_ += t * t;
        tp_ += t * p;
        pp_ += p * p;
    }
}

void StretchMeter::end_block() {
    const std::size_t count = end_of(block_) - (block_ == 0 ? 0 : end_of(block_ - 1));
    const double mean = block_sum_ / static_cast<double>(count);
    sum_ += mean;
    square_ += mean * mean;
    ++block_;
}

/// Mean velocity; its error from the scatter of ten block means, since neighbouring samples are not
/// independent.
void StretchMeter::speed_from_velocity(Stretch& stretch) const {
    if (count_ < blocks) return;
    const double mean = sum_ / blocks;
    const double variance = std::max(0.0, square_ / blocks - mean * mean) * blocks / (blocks - 1.0);
    stretch.speed = DegPerSec(mean);
    stretch.speed_error_deg_s = std::sqrt(variance / blocks);
}

/// Slope of position over time by least squares, with its standard error.
void StretchMeter::speed_from_position(Stretch& stretch) const {
    if (!(tt_ > 0.0)) return;
    const auto n = static_cast<double>(count_);
    stretch.speed = DegPerSec(tp_ / tt_);
    // What is left about a straight line is slow (control, encoder): ten independent pieces, not n.
    const double left = std::max(0.0, pp_ - tp_ * tp_ / tt_) / n;
    stretch.speed_error_deg_s = std::sqrt(left / (tt_ / n) / 10.0);
}

void StretchMeter::turning_speed(Stretch& stretch) const {
    if (!(speeds_ > 0.0)) return;
    const double mean = squares_ / speeds_;
    stretch.turning_deg_s = mean;
    stretch.turning_spread_deg_s = std::sqrt(std::max(0.0, cubes_ / speeds_ - mean * mean));
}

Stretch StretchMeter::stretch(Hertz rate, const SteadyRule& rule) const {
    Stretch stretch;
    stretch.count = count_;
    stretch.duration = Seconds(count_ == 0 ? 0.0 : last_s_ - first_s_ + 1.0 / rate.value());
    speed_from_velocity(stretch);
    turning_speed(stretch);
    if (!has_position_) return stretch;
    const DegPerSec from_velocity = stretch.speed;
    speed_from_position(stretch);
    // A position that wraps or resets inside the stretch contradicts the velocity; then velocity is trusted.
    const double limit = std::max(rule.band_deg_s, 0.5 * std::abs(from_velocity.value()));
    if (std::abs(stretch.speed.value() - from_velocity.value()) > limit) speed_from_velocity(stretch);
    return stretch;
}

}  // namespace ripplenotch
