// SPDX-License-Identifier: MIT
#include "filter/map/map_runner.hpp"

#include <cmath>
#include <numbers>
#include <utility>

#include "filter/rate_edge.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

MapRunner::MapRunner(RippleMap map)
    : map_(std::move(map)), weights_(map_.form.columns()), amplitudes_(map_.orders.size()) {}

void MapRunner::at(double speed_deg_s, double motor_turns, double torque_nm) noexcept {
    const double position_deg = 360.0 * motor_turns / map_.gear_ratio.value();
    map_weights(map_, {speed_deg_s, position_deg, torque_nm}, weights_);
    for (std::size_t i = 0; i < amplitudes_.size(); ++i) amplitudes_[i] = map_amplitude(map_, i, weights_);
}

double MapRunner::ripple(double motor_turns, double step_turns) const noexcept {
    double sum = 0.0;
    for (std::size_t i = 0; i < amplitudes_.size(); ++i) {
        const double order = map_.orders[i].value();
        const double share = share_below_rate(order * std::abs(step_turns));
        if (share == 0.0) continue;
        const double cycles = order * motor_turns;
        const double phase = 2.0 * std::numbers::pi * (cycles - std::floor(cycles));
        sum += share *
               (amplitudes_[i].real() * portable::cos(phase) + amplitudes_[i].imag() * portable::sin(phase));
    }
    return sum;
}

}  // namespace ripplenotch
