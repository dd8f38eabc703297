// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <numbers>

#include "ripplenotch/analysis/steady.hpp"

namespace ripplenotch {

namespace {
constexpr double least_turned_deg = 10.0;  // less than this is a joint that holds its place
// Student's t of five degrees of freedom over the normal distribution's, at 95 %.
constexpr double few_blocks = 2.571 / 1.960;
constexpr double least_over_noise = 5.0;  // a mean speed within so many deviations of the noise is none
}  // namespace

// A place u in a stretch, from 0 to 1, counts u^2 (1 - u)^2 for the slope of the position and u^3 (1 - u)^3
// for the mean velocity: alike, since the slope of an angle weighs the velocity by the integral of its own
// weights. These are near the Hann window's, so that the speed is that of the frequency which a spectrum
// tells: evenly weighed, the ends of a stretch, where the joint still gains speed, made it up to 1.6e-4 low.
void StretchMeter::add(const TraceView& rows) {
    if (rows.size() == 0) return;
    if (rows_ == 0) first_s_ = rows.time_s.front();
    last_s_ = rows.time_s.back();
    has_position_ = rows.has_position();
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const double along = (static_cast<double>(rows_) + 0.5) / static_cast<double>(count_);
        const double aside = along * (1.0 - along), weight = aside * aside * aside;
        block_weight_ += weight;
        block_sum_ += weight * rows.velocity_deg_s[k];
        const double change = rows.velocity_deg_s[k] - velocity_deg_s_;
        if (rows_ >= 2) bends_deg_s_ += std::abs(change - change_deg_s_);
        change_deg_s_ = change;
        velocity_deg_s_ = rows.velocity_deg_s[k];
        const double speed = std::abs(rows.velocity_deg_s[k]);
        speeds_ += speed;
        squares_ += speed * speed;
        cubes_ += speed * speed * speed;
        // A stretch of fewer rows than blocks has empty ones.
        for (++rows_; block_ < blocks && rows_ >= end_of(block_);) end_block();
        if (!has_position_) continue;
        slope_.add(rows.time_s[k] - mean_s_, rows.position_deg[k] - mean_position_deg_, aside * aside);
    }
}

void StretchMeter::end_block() {
    const double mean = block_weight_ > 0.0 ? block_sum_ / block_weight_ : 0.0;
    weight_ += block_weight_;
    squared_weight_ += block_weight_ * block_weight_;
    sum_ += block_weight_ * mean;
    square_ += block_weight_ * mean * mean;
    block_weight_ = block_sum_ = 0.0;
    ++block_;
}

/// Mean velocity, its error from the scatter of ten block means, since neighbouring samples are not
/// independent. By their weights six of the ten count, and an error from so few is widened.
void StretchMeter::speed_from_velocity(Stretch& stretch) const {
    if (count_ < blocks) return;
    const double mean = sum_ / weight_, shared = squared_weight_ / (weight_ * weight_);
    const double variance = std::max(0.0, square_ / weight_ - mean * mean) / (1.0 - shared);
    stretch.speed = DegPerSec(mean);
    stretch.speed_error_deg_s = few_blocks * std::sqrt(variance * shared);
}

void StretchMeter::Slope::add(double t, double p, double weight) {
    sum_ += weight;
    t_ += weight * t;
    p_ += weight * p;
    tt_ += weight * t * t;
    tp_ += weight * t * p;
    pp_ += weight * p * p;
    square_t_ += weight * weight * t * t;
}

/// Slope of position over time by weighted least squares, with its standard error.
void StretchMeter::speed_from_position(Stretch& stretch) const {
    if (!(slope_.tt() > 0.0)) return;
    const double slope = slope_.tp() / slope_.tt();
    stretch.speed = DegPerSec(slope);
    // What is left about a straight line is slow (control, encoder): ten independent pieces, not count_.
    const double left = std::max(0.0, slope_.pp() - slope * slope_.tp()) / slope_.weight();
    const double pieces = static_cast<double>(count_) / 10.0;
    stretch.speed_error_deg_s = std::sqrt(left * pieces * slope_.square_t()) / slope_.tt();
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
