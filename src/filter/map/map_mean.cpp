// SPDX-License-Identifier: MIT
#include "filter/map/map_mean.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr double sought_turns = 1.0;  ///< of the motor
constexpr int places_tried = 720;     ///< tried in a turn, before the best is refined

std::complex<double> turned(std::complex<double> z, double cycles) {
    const double phase = 2.0 * std::numbers::pi * (cycles - std::floor(cycles));
    return z * portable::polar(1.0, -phase);
}

}  // namespace

double largest_amplitude(const RippleMap& map, std::size_t order) {
    const std::size_t each = map.form.columns_a_direction(), speeds = map.form.speeds_deg_s.size();
    double largest = 0.0;
    for (std::size_t d = 0; d < map.form.directions; ++d) {
        double at_speed = 0.0, added = 0.0;
        double second = 0.0;
        for (std::size_t c = 0; c < map.form.load_column(); ++c) {
            const std::complex<double> z = map.values[order][d * each + c];
            const double size = portable::hypot(z.real(), z.imag());
            if (c < speeds)
                at_speed = std::max(at_speed, size);
            else if (map.form.is_second_comb(c))
                second = std::max(second, size);
            else
                added += size;
        }
        largest = std::max(largest, at_speed + second + added);
    }
    return largest;
}

MapMean::MapMean(RippleMap map, double noise_nm, std::optional<RippleMap> warming)
    : runner_(std::move(map), std::move(warming)), noise_nm_(noise_nm), found_(runner_.map().orders.size()) {}

void MapMean::restart(bool seek) noexcept {
    seeks_ = seek;
    shift_turns_ = turned_ = 0.0;
}

double MapMean::ripple(double speed_deg_s, double torque_nm, const MotorAngle& angle) noexcept {
    runner_.at(speed_deg_s, angle.turns(), torque_nm);
    return seeks_ ? 0.0 : runner_.ripple(angle.turns() + shift_turns_, angle.step_turns());
}

// Squares between what the filter found and the map at this shift.
double MapMean::misfit(double shift_turns) const noexcept {
    double sum = 0.0;
    for (std::size_t i = 0; i < found_.size(); ++i) {
        const auto said =
            turned(runner_.amplitude(i) / noise_nm_, runner_.map().orders[i].value() * shift_turns);
        sum += found_[i].weight * std::norm(std::complex<double>(found_[i].cosine, found_[i].sine) - said);
    }
    return sum;
}

void MapMean::seek(RippleKalman& filter, const MotorAngle& angle) noexcept {
    if (!seeks_) return;
    turned_ += std::abs(angle.step_turns());
    if (turned_ < sought_turns) return;
    for (std::size_t i = 0; i < found_.size(); ++i) {
        const AmplitudePrior one = filter.amplitude(i);
        const double stray = runner_.map().spread_nm[i] / noise_nm_;
        found_[i] = {one.cosine, one.sine, 1.0 / (one.deviation * one.deviation + stray * stray + 1.0)};
    }
    double best = misfit(0.0);
    int at = 0;
    for (int k = 1; k < places_tried; ++k) {
        const double one = misfit(static_cast<double>(k) / places_tried);
        if (one < best) {
            best = one;
            at = k;
        }
    }
    // The bottom of the parabola through the best place and its neighbours.
    const double step = 1.0 / places_tried, middle = static_cast<double>(at) * step;
    const double before = misfit(middle - step), after = misfit(middle + step);
    const double bend = before - 2.0 * best + after;
    shift_turns_ = middle + (bend > 0.0 ? 0.5 * step * (before - after) / bend : 0.0);
    for (std::size_t i = 0; i < found_.size(); ++i) {
        const auto said =
            turned(runner_.amplitude(i) / noise_nm_, runner_.map().orders[i].value() * shift_turns_);
        filter.count_from(i, said.real(), said.imag());
    }
    seeks_ = false;
}

}  // namespace ripplenotch
