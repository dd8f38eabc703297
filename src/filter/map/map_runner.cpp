// SPDX-License-Identifier: MIT
#include "filter/map/map_runner.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include "ripplenotch/core/phasor.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/design/rate_edge.hpp"

namespace ripplenotch {

namespace {

// Into rooms that are large enough: nothing is allocated.
void put_at_temperature(const RippleMap& map, double degc, RippleMap& there) {
    const MapRange& seen = map.temperatures_degc;
    const double warmer = std::clamp(degc, seen.from, seen.to) - seen.middle();
    const std::size_t each = map.form.columns_a_direction(), speeds = map.form.speeds_deg_s.size();
    for (std::size_t i = 0; i < map.values.size(); ++i) {
        there.values[i].clear();
        for (std::size_t c = 0; c < map.values[i].size(); ++c) {
            const std::size_t within = c % each, column = c - within + map.form.temperature_column();
            if (within == map.form.temperature_column()) continue;
            there.values[i].push_back(map.values[i][c] +
                                      (within < speeds ? warmer * map.values[i][column] : 0.0));
        }
    }
}

}  // namespace

RippleMap at_temperature(const RippleMap& map, double degc) {
    RippleMap there = map;
    there.form.by_temperature = false;
    put_at_temperature(map, degc, there);
    return there;
}

MapRunner::MapRunner(RippleMap map, std::optional<RippleMap> warming)
    : map_(std::move(map)),
      warming_(std::move(warming)),
      weights_(map_.form.columns()),
      amplitudes_(map_.orders.size()) {}

void MapRunner::warm(double degc) noexcept {
    const double told = std::round(1000.0 * degc) / 1000.0;
    if (!warming_ || told == degc_) return;
    degc_ = told;
    put_at_temperature(*warming_, told, map_);
}

void MapRunner::at(double speed_deg_s, double motor_turns, double torque_nm) noexcept {
    const double position_deg = 360.0 * motor_turns / map_.gear_ratio.value();
    map_weights(map_, {speed_deg_s, position_deg, torque_nm}, weights_);
    for (std::size_t i = 0; i < amplitudes_.size(); ++i)
        amplitudes_[i] = map_amplitude(map_, i, weights_, position_deg);
}

double MapRunner::ripple(double motor_turns, double step_turns) const noexcept {
    double sum = 0.0;
    for (std::size_t i = 0; i < amplitudes_.size(); ++i) {
        const double order = map_.orders[i].value();
        const double share = share_below_rate(order * std::abs(step_turns));
        if (share == 0.0) continue;
        const double cycles = order * motor_turns;
        const double phase = 2.0 * std::numbers::pi * (cycles - std::floor(cycles));
        const std::complex<double> on_circle = portable::phasor(phase);
        sum += share * (amplitudes_[i].real() * on_circle.real() + amplitudes_[i].imag() * on_circle.imag());
    }
    return sum;
}

}  // namespace ripplenotch
