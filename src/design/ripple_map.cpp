// SPDX-License-Identifier: MIT
#include "ripplenotch/design/ripple_map.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr double slowest_blend_deg_s = 0.1;  ///< the sign of a slower speed is noise

double radians_of_turns(double turns) { return 2.0 * std::numbers::pi * (turns - std::floor(turns)); }

// One direction's columns, times `share`.
void add_direction(const RippleMap& map, const MapState& state, double share, std::span<double> weights) {
    const std::vector<double>& knots = map.form.speeds_deg_s;
    const double speed = std::clamp(std::abs(state.speed_deg_s), knots.front(), knots.back());
    std::size_t above = 0;
    while (above + 1 < knots.size() && knots[above] < speed) ++above;
    for (std::size_t comb = 0; comb < map.form.columns_a_direction(); comb += knots.size()) {
        if (above == 0) {
            weights[comb] += share;
        } else {
            const double along = (speed - knots[above - 1]) / (knots[above] - knots[above - 1]);
            weights[comb + above - 1] += share * (1.0 - along);
            weights[comb + above] += share * along;
        }
    }
}

}  // namespace

void map_weights(const RippleMap& map, const MapState& state, std::span<double> weights) {
    std::fill(weights.begin(), weights.end(), 0.0);
    if (map.form.directions == 1) {
        add_direction(map, state, 1.0, weights);
        return;
    }
    const double full_at = std::max(map.speeds_deg_s.from, slowest_blend_deg_s);
    const double forward = std::clamp(0.5 + 0.5 * state.speed_deg_s / full_at, 0.0, 1.0);
    const std::size_t half = map.form.columns_a_direction();
    if (forward > 0.0) add_direction(map, state, forward, weights.first(half));
    if (forward < 1.0) add_direction(map, state, 1.0 - forward, weights.last(half));
}

std::complex<double> second_comb_phasor(const RippleMap& map, std::size_t order, double position_deg) {
    if (map.form.second_comb == 0) return 1.0;
    const double cycles = map.orders[order].value() * (position_deg - map.zero_deg) / 360.0;
    return portable::polar(1.0, -map.form.second_comb * radians_of_turns(cycles));
}

std::complex<double> map_amplitude(const RippleMap& map, std::size_t order, std::span<const double> weights,
                                   double position_deg) {
    const std::vector<std::complex<double>>& values = map.values[order];
    std::complex<double> sum = 0.0, second = 0.0;
    const std::size_t each = map.form.columns_a_direction(), knots = map.form.speeds_deg_s.size();
    for (std::size_t d = 0; d < weights.size(); d += each) {
        for (std::size_t c = d; c < d + knots; ++c) sum += weights[c] * values[c];
        for (std::size_t c = d + knots; c < d + each; ++c) second += weights[c] * values[c];
    }
    if (map.form.second_comb == 0) return sum;
    return sum + second_comb_phasor(map, order, position_deg) * second;
}

double map_torque(const RippleMap& map, const MapState& state) {
    std::vector<double> weights(map.form.columns());
    map_weights(map, state, weights);
    const double motor_turns = map.gear_ratio.value() * (state.position_deg - map.zero_deg) / 360.0;
    double torque = 0.0;
    for (std::size_t i = 0; i < map.orders.size(); ++i) {
        const std::complex<double> z = map_amplitude(map, i, weights, state.position_deg);
        const double phase = radians_of_turns(map.orders[i].value() * motor_turns);
        torque += z.real() * portable::cos(phase) + z.imag() * portable::sin(phase);
    }
    return torque;
}

RippleMap with_zero(const RippleMap& map, double zero_deg) {
    RippleMap moved = map;
    moved.zero_deg = zero_deg;
    const double by_deg = zero_deg - map.zero_deg;
    const double motor_turns = map.gear_ratio.value() * by_deg / 360.0;
    for (std::size_t i = 0; i < map.orders.size(); ++i) {
        std::vector<std::complex<double>>& z = moved.values[i];
        const auto turned = portable::polar(1.0, -radians_of_turns(map.orders[i].value() * motor_turns));
        const std::complex<double> second = turned * second_comb_phasor(map, i, zero_deg);
        for (std::size_t c = 0; c < z.size(); ++c) z[c] *= map.form.is_second_comb(c) ? second : turned;
    }
    return moved;
}

}  // namespace ripplenotch
