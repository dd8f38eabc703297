// SPDX-License-Identifier: MIT
#include "filter/map/map_runner.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/design/candidate_table.hpp"

namespace ripplenotch {
namespace {

constexpr double sought_turns = 1.0;  ///< periods of the lowest order
constexpr int places_tried = 720;     ///< tried in a turn, before the best is refined
// The speeds of a map are means over its windows, where the joint moved evenly: peaks of the same motion are
// a quarter above them on a robot.
constexpr double faster_than_seen = 1.5;

double radians_of(double cycles) { return 2.0 * std::numbers::pi * (cycles - std::floor(cycles)); }

}  // namespace

double largest_amplitude(const RippleMap& map, std::size_t order) {
    const std::size_t each = map.form.columns_a_direction(), knots = map.form.speeds_deg_s.size();
    double largest = 0.0;
    for (std::size_t from = 0; from < map.form.columns(); from += each) {
        const auto size = [&](std::size_t column) {
            const std::complex<double> z = map.values[order][from + column];
            return portable::hypot(z.real(), z.imag());
        };
        double at_speed = 0.0;
        for (std::size_t k = 0; k < knots; ++k)
            at_speed = std::max(at_speed, size(k) + (map.form.second_comb == 0 ? 0.0 : size(k + knots)));
        largest = std::max(largest, at_speed);
    }
    return largest;
}

MapRunner::MapRunner(RippleMap map)
    : map_(std::move(map)), weights_(map_.form.columns()), amplitudes_(map_.orders.size()) {}

void MapRunner::at(double speed_deg_s, double motor_turns) noexcept {
    const double position_deg = 360.0 * motor_turns / map_.gear_ratio.value();
    map_weights(map_, {speed_deg_s, position_deg}, weights_);
    for (std::size_t i = 0; i < amplitudes_.size(); ++i)
        amplitudes_[i] = map_amplitude(map_, i, weights_, position_deg);
}

double MapRunner::ripple(double motor_turns, double step_turns) const noexcept {
    double sum = 0.0;
    for (std::size_t i = 0; i < amplitudes_.size(); ++i) {
        const double order = map_.orders[i].value();
        const double share = share_below_rate(order * std::abs(step_turns));
        if (share == 0.0) continue;
        const std::complex<double> on_circle = portable::phasor(radians_of(order * motor_turns));
        sum += share * (amplitudes_[i].real() * on_circle.real() + amplitudes_[i].imag() * on_circle.imag());
    }
    return sum;
}

MapMean::MapMean(RippleMap map, double noise_nm)
    : runner_(std::move(map)), noise_nm_(noise_nm), found_(runner_.map().orders.size()) {}

void MapMean::restart(bool seek) noexcept {
    seeks_ = seek;
    shift_turns_ = turned_ = 0.0;
}

double MapMean::ripple(double speed_deg_s, const MotorAngle& angle) noexcept {
    runner_.at(speed_deg_s, angle.turns());
    return seeks_ ? 0.0 : runner_.ripple(angle.turns() + shift_turns_, angle.step_turns());
}

std::complex<double> MapMean::shifted(std::size_t order, double shift_turns) const noexcept {
    const double phase = radians_of(runner_.map().orders[order].value() * shift_turns);
    return runner_.amplitude(order) / noise_nm_ * portable::polar(1.0, -phase);
}

// Squared difference between the filter's estimate and the map at this shift.
double MapMean::misfit(double shift_turns) const noexcept {
    double sum = 0.0;
    for (std::size_t i = 0; i < found_.size(); ++i) {
        const std::complex<double> found(found_[i].cosine, found_[i].sine);
        sum += found_[i].weight * std::norm(found - shifted(i, shift_turns));
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
        const std::complex<double> there = shifted(i, shift_turns_);
        filter.count_from(i, there.real(), there.imag());
    }
    seeks_ = false;
}

MapReach::MapReach(std::string_view method, const Settings& settings, double gear_ratio,
                   double sample_rate_hz)
    : method_(method),
      slowest_deg_s_(settings.number("slowest")),
      deg_s_a_turn_a_sample_(360.0 / gear_ratio * sample_rate_hz) {
    if (settings.has("fastest") && settings.text("beyond") == "refuse")
        fastest_deg_s_ = settings.number("fastest");
}

void MapReach::judge() {
    const double speed_deg_s = std::abs(turned_) / samples_ * deg_s_a_turn_a_sample_;
    if (speed_deg_s > faster_than_seen * fastest_deg_s_) {
        raise<DataError>(
            "method {}: its map was made at {:.3g} to {:.3g} deg/s, and this joint moves at {:.3g} deg/s: it "
            "is the map of another joint, or of too slow logs; beyond=hold takes its edge there",
            method_, slowest_deg_s_, fastest_deg_s_, speed_deg_s);
    }
    restart();
}

}  // namespace ripplenotch
