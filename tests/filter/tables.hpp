// SPDX-License-Identifier: MIT
#pragma once
// Candidate tables and signals that several tests of this room use.

#include <cmath>
#include <cstring>
#include <numbers>
#include <random>
#include <vector>

#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/filter/method.hpp"

namespace ripplenotch::testing {

/// Table 1 of the paper: 18 to 180 deg/s in steps of 18, gear ratio 100, orders 1 and 2, Q 1/4, 1 kHz.
inline CandidateTable paper_table(OutsideRule below = OutsideRule::pass,
                                  OutsideRule above = OutsideRule::hold) {
    return CandidateTable::design(
        {.gear_ratio = GearRatio(100.0),
         .orders = {Order(1.0), Order(2.0)},
         .sample_rate = Hertz(1000.0),
         .bands = bands_by_spacing({DegPerSec(18.0), DegPerSec(180.0)}, DegPerSec(18.0)),
         .below = below,
         .above = above});
}

/// Gear ratio 100 at 1 kHz, bands to be filled in.
inline TableSpec table_spec(std::vector<Order> orders = {Order(1.0), Order(2.0)}) {
    TableSpec spec;
    spec.gear_ratio = GearRatio(100.0);
    spec.orders = std::move(orders);
    spec.sample_rate = Hertz(1000.0);
    return spec;
}

/// A table whose bands all hold the filter of one frequency pair: a switch between them must not be noticed.
inline CandidateTable equal_table(std::size_t count) {
    TableSpec spec = table_spec();
    std::vector<Band> bands;
    for (std::size_t i = 0; i < count; ++i) {
        Band band;
        band.number = static_cast<int>(i) + 1;
        band.from = DegPerSec(20.0 * static_cast<double>(i));
        band.to = DegPerSec(20.0 * static_cast<double>(i + 1));
        for (const double order : {1.0, 2.0}) {
            const NotchSpec notch{.center = Hertz(20.0 * order), .q = 0.7};
            band.notches.push_back({Order(order), notch, design_notch(notch, spec.sample_rate)});
        }
        spec.bands.emplace_back(band.from, band.to);
        bands.push_back(std::move(band));
    }
    return CandidateTable::from_bands(spec, std::move(bands));
}

struct Signals {
    std::vector<double> velocity_deg_s, torque_nm, position_deg;

    [[nodiscard]] Samples samples() const { return {velocity_deg_s, torque_nm, position_deg}; }
    [[nodiscard]] Samples part(std::size_t first, std::size_t count) const {
        return {std::span(velocity_deg_s).subspan(first, count), std::span(torque_nm).subspan(first, count),
                std::span(position_deg).subspan(first, count)};
    }
};

/// A joint that wanders over all speeds, both ways, with ripple and noise at 1 kHz.
inline Signals wandering(std::size_t count, unsigned seed) {
    std::mt19937 engine(seed);
    std::normal_distribution<double> noise;
    Signals s;
    double angle = 0.0;
    const double phase = std::uniform_real_distribution<double>(0.0, 6.0)(engine);
    for (std::size_t k = 0; k < count; ++k) {
        const double t = static_cast<double>(k) / 1000.0;
        const double v = 210.0 * std::sin(2.1 * t + phase) * std::sin(0.7 * t + 1.0) + 0.5 * noise(engine);
        angle += v / 1000.0;
        const double motor = 100.0 * angle * std::numbers::pi / 180.0;
        s.velocity_deg_s.push_back(v);
        s.position_deg.push_back(angle);
        s.torque_nm.push_back(5.0 * std::sin(1.3 * t) + std::sin(motor) + 0.4 * std::sin(2.0 * motor) +
                              0.05 * noise(engine));
    }
    return s;
}

inline std::unique_ptr<CausalFilter> start(const std::string& text, const CandidateTable* table = nullptr,
                                           Hertz sample_rate = Hertz(1000.0)) {
    const Spec spec = parse_spec(text);
    const Method& method = find_method(spec.name);
    return method.start(Settings("method " + spec.name, spec, method.keys), sample_rate,
                        method.needs_table ? table : nullptr);
}

inline std::vector<double> filtered(CausalFilter& filter, const Samples& in) {
    std::vector<double> out(in.torque_nm.size());
    filter.process(in, out);
    return out;
}

/// The comparison of transitions, worked out independently with SciPy: 20 s at 1 kHz, 20 deg/s for 5 s, a
/// ramp to 40 deg/s in 10 s, hold; torque 10 + 2 sin(theta + 0.3) + sin(2 theta + 1.1) Nm, theta the motor
/// angle by trapezoids.
inline Signals ramp() {
    Signals s;
    double angle_deg = 0.0, last = 20.0;
    for (std::size_t k = 0; k < 20000; ++k) {
        const double t = static_cast<double>(k) / 1000.0;
        const double v = t < 5.0 ? 20.0 : t < 15.0 ? 20.0 + 2.0 * (t - 5.0) : 40.0;
        if (k > 0) angle_deg += 0.5 * (last + v) / 1000.0;
        last = v;
        const double theta = 100.0 * angle_deg * std::numbers::pi / 180.0;
        s.velocity_deg_s.push_back(v);
        s.position_deg.push_back(angle_deg);
        s.torque_nm.push_back(10.0 + 2.0 * std::sin(theta + 0.3) + std::sin(2.0 * theta + 1.1));
    }
    return s;
}

inline bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

inline double between(double low, double high, std::mt19937& engine) {
    return std::uniform_real_distribution<double>(low, high)(engine);
}

}  // namespace ripplenotch::testing
