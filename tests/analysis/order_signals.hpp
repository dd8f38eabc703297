// SPDX-License-Identifier: MIT
#pragma once
// Run-ups of rotating shafts with known orders: the closed-form examples that order-tracking tools are judged
// by.

#include <cmath>
#include <numbers>
#include <vector>

#include "analysis/traces.hpp"
#include "ripplenotch/analysis/order_track.hpp"

namespace ripplenotch::tests {

struct ShaftLine {
    double order = 1.0, amplitude_nm = 1.0, phase_rad = 0.0;
};

/// Owns what a TrackedSignal borrows.
struct ShaftSignal {
    double rate_hz = 1000.0;
    std::vector<double> time_s, torque_nm, speed_deg_s, turns;

    [[nodiscard]] TrackedSignal tracked(const std::vector<double>& orders) const {
        TrackedSignal signal{Hertz(rate_hz), time_s, torque_nm, speed_deg_s, turns, {}};
        for (const double order : orders) signal.lines.push_back({order, turns});
        return signal;
    }
    [[nodiscard]] TraceView view() const { return {Hertz(rate_hz), time_s, speed_deg_s, torque_nm, {}}; }
};

/// Straight from x0 to x1 over n values.
inline std::vector<double> straight(double x0, double x1, std::size_t n) {
    std::vector<double> x(n);
    for (std::size_t k = 0; k < n; ++k)
        x[k] = x0 + (x1 - x0) * static_cast<double>(k) / static_cast<double>(n - 1);
    return x;
}

/// Turns of a shaft by the trapezoid rule over its samples.
inline std::vector<double> turned(const std::vector<double>& turns_per_s, double rate_hz) {
    std::vector<double> turns(turns_per_s.size(), 0.0);
    for (std::size_t k = 1; k < turns.size(); ++k) {
        turns[k] = turns[k - 1] + 0.5 * (turns_per_s[k] + turns_per_s[k - 1]) / rate_hz;
    }
    return turns;
}

/// A shaft of the speeds given, torque 0.
inline ShaftSignal shaft(const std::vector<double>& turns_per_s, double rate_hz) {
    ShaftSignal signal;
    signal.rate_hz = rate_hz;
    signal.turns = turned(turns_per_s, rate_hz);
    signal.torque_nm.assign(turns_per_s.size(), 0.0);
    for (std::size_t k = 0; k < turns_per_s.size(); ++k) {
        signal.time_s.push_back(static_cast<double>(k) / rate_hz);
        signal.speed_deg_s.push_back(360.0 * turns_per_s[k]);
    }
    return signal;
}

inline void add_line(ShaftSignal& signal, const ShaftLine& line) {
    for (std::size_t k = 0; k < signal.turns.size(); ++k) {
        signal.torque_nm[k] +=
            line.amplitude_nm *
            std::cos(2.0 * std::numbers::pi * line.order * signal.turns[k] + line.phase_rad);
    }
}

inline void add_noise(ShaftSignal& signal, double rms_nm, std::uint32_t seed) {
    Noise noise(seed);
    for (double& torque : signal.torque_nm) torque += rms_nm * noise();
}

/// A run-up from 600 to 2400 rpm in 5 s at 600 Hz with orders 1, 1/2, 4 and 6 (the example of MATLAB's
/// ordertrack and orderwaveform).
inline const std::vector<double> run_up_orders{1.0, 0.5, 4.0, 6.0};
inline const std::vector<double> run_up_amplitudes{1.0, 0.5, std::numbers::sqrt2, 2.0};
inline ShaftSignal run_up() {
    ShaftSignal signal = shaft(straight(10.0, 40.0, 3001), 600.0);
    for (std::size_t i = 0; i < run_up_orders.size(); ++i) {
        add_line(signal, {run_up_orders[i], run_up_amplitudes[i], 0.0});
    }
    return signal;
}

/// Two shafts whose orders cross at about 0.913 s and 44.9 Hz: 600 to 6000 rpm and 3000 to 4200 rpm in 3 s at
/// 300 Hz; order 1.2 of the first, whose amplitude swells by half in the middle, and order 0.8 of the second.
struct CrossingSignal {
    ShaftSignal first, second;  ///< the torque, of both, is in `first`
    std::vector<double> first_amplitude;
    static constexpr double first_order = 1.2, second_order = 0.8;
    static constexpr double second_amplitude = 4.0 * std::numbers::sqrt2;

    [[nodiscard]] TrackedSignal tracked() const {
        TrackedSignal signal = first.tracked({first_order});
        signal.lines.push_back({second_order, second.turns});
        return signal;
    }
    [[nodiscard]] double first_amplitude_at(double time_s) const {
        return first_amplitude[static_cast<std::size_t>(std::lround(time_s * first.rate_hz))];
    }
};
inline CrossingSignal crossing() {
    constexpr std::size_t n = 900;
    CrossingSignal signal{shaft(straight(10.0, 100.0, n), 300.0), shaft(straight(50.0, 70.0, n), 300.0), {}};
    const std::vector<double> u = straight(-10.0, 10.0, n);
    for (std::size_t k = 0; k < n; ++k) {
        const double amplitude = 2.0 * std::numbers::sqrt2 * (1.0 + 0.5 / (1.0 + std::pow(u[k], 4)));
        signal.first_amplitude.push_back(amplitude);
        const double one = 2.0 * std::numbers::pi * CrossingSignal::first_order * signal.first.turns[k];
        const double other = 2.0 * std::numbers::pi * CrossingSignal::second_order * signal.second.turns[k];
        signal.first.torque_nm[k] =
            amplitude * std::cos(one) + CrossingSignal::second_amplitude * std::cos(other);
    }
    return signal;
}

}  // namespace ripplenotch::tests
