// SPDX-License-Identifier: MIT
#pragma once
// Logs whose ripple is that of a known map.

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/design/ripple_map.hpp"

namespace ripplenotch::testing {

inline constexpr double mapped_ratio = 100.0;

inline GearAccount mapped_gear(std::vector<Order> orders = {Order(1.0), Order(2.0)}) {
    return {GearRatio(mapped_ratio), std::move(orders), {}, {}, "test"};
}

/// Orders 1 and 2, alike at every speed and in both directions: 0.8 and 0.5 Nm.
inline RippleMap plain_map() {
    RippleMap map;
    map.gear_ratio = GearRatio(mapped_ratio);
    map.orders = {Order(1.0), Order(2.0)};
    map.values = {{{0.6, -0.529}}, {{-0.3, 0.4}}};
    map.spread_nm = {0.0, 0.0};
    return map;
}

/// Order 2 by speed (10 and 110 deg/s) and direction, with a harmonic of the joint's turn.
inline RippleMap rich_map() {
    RippleMap map;
    map.gear_ratio = GearRatio(mapped_ratio);
    map.orders = {Order(2.0)};
    map.form = {{10.0, 110.0}, 2, 1, false};
    map.speeds_deg_s = {10.0, 110.0};
    map.values = {
        {{0.5, 0.1}, {0.2, -0.4}, {0.15, 0.0}, {0.0, 0.2}, {-0.1, 0.6}, {0.4, 0.3}, {0.1, 0.1}, {0.2, 0.0}}};
    map.spread_nm = {0.0};
    return map;
}

/// The same without that harmonic.
inline RippleMap speed_map() {
    RippleMap map = rich_map();
    map.form.turn_harmonics = 0;
    map.values = {{{0.5, 0.1}, {0.2, -0.4}, {-0.1, 0.6}, {0.4, 0.3}}};
    return map;
}

/// Orders 1 and 2 of both combs, n 100 and n 101 cycles per output turn, alike at every speed.
inline RippleMap two_comb_map() {
    RippleMap map = plain_map();
    map.form.second_comb = 1;
    map.values = {{{0.1, 0.2}, {0.5, -0.3}}, {{-0.3, 0.4}, {0.1, -0.3}}};
    return map;
}

/// A joint that swings at up to 110 deg/s under a slow torque, at 1 kHz, with this ripple and white noise.
/// The encoder counts `shift_deg` more than the map does.
inline Trace mapped_log(const RippleMap& map, double seconds, double noise_nm, unsigned seed,
                        double shift_deg = 0.0, double swing_rad_s = 0.9) {
    std::mt19937 engine(seed);
    std::normal_distribution<double> noise;
    const double phase = std::uniform_real_distribution<double>(0.0, 6.0)(engine);
    Trace trace;
    trace.sample_rate = Hertz(1000.0);
    double position = 7.0;
    for (std::size_t k = 0; static_cast<double>(k) < 1000.0 * seconds; ++k) {
        const double t = static_cast<double>(k) / 1000.0;
        const double v = 80.0 * std::sin(swing_rad_s * t + phase) + 30.0 * std::sin(0.37 * t);
        if (k > 0) position += (trace.velocity_deg_s.back() + v) / 2000.0;
        trace.time_s.push_back(t);
        trace.velocity_deg_s.push_back(v);
        trace.position_deg.push_back(position + shift_deg);
        trace.torque_nm.push_back(6.0 * std::sin(0.5 * t) + map_torque(map, {v, position, 0.0}) +
                                  noise_nm * noise(engine));
    }
    return trace;
}

}  // namespace ripplenotch::testing
