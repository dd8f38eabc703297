// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <numbers>

#include "ripplenotch/analysis/steady.hpp"

namespace ripplenotch {

namespace {
constexpr double least_turned_deg = 10.0;  // less than this is a joint that holds its place
constexpr double least_over_noise = 5.0;   // a mean speed within so many deviations of the noise is none
}  // namespace

void StretchMeter::add(const TraceView& rows) {
    if (rows.size() == 0) return;
    if (rows_ == 0) first_s_ = rows.time_s.front();
    last_s_ = rows.time_s.back();
    has_position_ = rows.has_position();
    for (std::size_t k = 0; k < rows.size(); ++k) {
        block_sum_ += rows.velocity_deg_s[k];
        const double change = rows.velocity_deg_s[k] - velocity_deg_s_;
        if (rows_ >= 2) bends_deg_s_ += std::abs(change - change_deg_s_);
        change_deg_s_ = change;
        velocity_deg_s_ = rows.velocity_deg_s[k];
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

/// Moments of the speed's size weighted by that size. White noise of variance s adds s to the mean square,
/// and three times s times the mean to the mean cube. It is read from second differences, whose variance is 6
/// s, by their mean size: a single jump must not count, nor a smooth course.
void StretchMeter::turning_speed(Stretch& stretch, Hertz rate) const {
    if (rows_ < 3 || !(speeds_ / rate.value() >= least_turned_deg)) return;
    const double bend = bends_deg_s_ / static_cast<double>(rows_ - 2);
    const double noise = bend * bend * std::numbers::pi / 12.0;
    const double mean = (squares_ - static_cast<double>(rows_) * noise) / speeds_;
    if (!(mean > least_over_noise * std::sqrt(noise))) return;
    stretch.turning_deg_s = mean;
    stretch.turning_spread_deg_s = std::sqrt(std::max(0.0, cubes_ / speeds_ - 3.0 * noise - mean * mean));
}

Stretch StretchMeter::stretch(Hertz rate, const SteadyRule& rule) const {
    Stretch stretch;
    stretch.count = count_;
    stretch.duration = Seconds(count_ == 0 ? 0.0 : last_s_ - first_s_ + 1.0 / rate.value());
    speed_from_velocity(stretch);
    turning_speed(stretch, rate);
    if (!has_position_) return stretch;
    const DegPerSec from_velocity = stretch.speed;
    speed_from_position(stretch);
    // A position that wraps or resets inside the stretch contradicts the velocity; then velocity is trusted.
    const double limit = std::max(rule.band_deg_s, 0.5 * std::abs(from_velocity.value()));
    if (std::abs(stretch.speed.value() - from_velocity.value()) > limit) speed_from_velocity(stretch);
    return stretch;
}

}  // namespace ripplenotch
