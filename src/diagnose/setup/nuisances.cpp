// SPDX-License-Identifier: MIT
#include "diagnose/setup/nuisances.hpp"

#include <cmath>

#include "diagnose/setup/smoothed_series.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

// A column of the log over the window.
std::vector<double> smoothed_column(std::span<const double> time_s, std::span<const double> values,
                                    const NuisanceColumns::Window& window) {
    const SmoothedSeries series(time_s, values, window.smoothing_s);
    std::vector<double> column;
    for (const double at_s : window.at_s) column.push_back(series.mean(at_s));
    return column;
}

// The position of the log, or else the integral of its velocity.
std::vector<double> angle_of(const TraceView& log) {
    if (log.has_position()) return {log.position_deg.begin(), log.position_deg.end()};
    std::vector<double> angle_deg(log.velocity_deg_s.size());
    for (std::size_t k = 1; k < angle_deg.size(); ++k)
        angle_deg[k] = angle_deg[k - 1] + 0.5 * (log.time_s[k] - log.time_s[k - 1]) *
                                              (log.velocity_deg_s[k - 1] + log.velocity_deg_s[k]);
    return angle_deg;
}

// The state of Dahl's friction along a position: it turns from -1 to 1 within about the width.
std::vector<double> dahl_state(std::span<const double> angle_deg, double width_deg) {
    std::vector<double> state(angle_deg.size());
    for (std::size_t k = 1; k < state.size(); ++k) {
        const double way = (angle_deg[k] - angle_deg[k - 1]) / width_deg;
        const double end = way > 0.0 ? 1.0 : -1.0;
        state[k] = end + (state[k - 1] - end) * portable::exp(-std::abs(way));
    }
    return state;
}

}  // namespace

NuisanceColumns::NuisanceColumns(const TraceView& log, std::optional<GearRatio> gear_ratio,
                                 const AlignmentOptions& options, const Window& window)
    : rows_(window.at_s.size()) {
    const auto smoothed = [&](std::span<const double> values) {
        return smoothed_column(log.time_s, values, window);
    };
    const std::span<const double> velocity = log.velocity_deg_s;
    if (log.has_position()) {
        std::vector<double> cosine(log.size()), sine(log.size());
        portable::cos_degrees(log.position_deg, cosine);
        portable::sin_degrees(log.position_deg, sine);
        gravity_ = {smoothed(cosine), smoothed(sine)};
    }
    if (velocity.empty()) return;
    std::vector<double> side(velocity.size());
    for (const double width_deg_s : {options.slow_width_deg_s, options.fast_width_deg_s}) {
        for (std::size_t k = 0; k < side.size(); ++k) side[k] = portable::tanh(velocity[k] / width_deg_s);
        friction_.push_back(smoothed(side));
    }
    friction_.push_back(smoothed(velocity));
    const SmoothedSeries speed(log.time_s, velocity, window.smoothing_s);
    inertia_.emplace_back();
    for (const double at_s : window.at_s) inertia_.back().push_back(speed.slope(at_s));
    const std::vector<double> angle_deg = angle_of(log);
    for (std::size_t k = 0; k < side.size(); ++k)
        side[k] = std::abs(log.torque_nm[k]) * portable::tanh(velocity[k] / options.slow_width_deg_s);
    load_ = {smoothed(side), smoothed(dahl_state(angle_deg, options.hysteresis_width_deg))};
    if (!gear_ratio) return;
    std::vector<double> wave(angle_deg.size()), swelling(angle_deg.size());
    for (const double order : {1.0, 2.0}) {
        for (const double quarter_deg : {0.0, 90.0}) {
            for (std::size_t k = 0; k < wave.size(); ++k) {
                wave[k] = portable::cos_degrees(order * gear_ratio->value() * angle_deg[k] - quarter_deg);
                swelling[k] = wave[k] * std::abs(velocity[k]);
            }
            ripple_.push_back(smoothed(wave));
            ripple_.push_back(smoothed(swelling));
        }
    }
}

std::vector<std::vector<double>> NuisanceColumns::of(const NuisanceChoice& choice) const {
    std::vector<std::vector<double>> columns{std::vector<double>(rows_, 1.0)};
    const auto add = [&](bool chosen, const std::vector<std::vector<double>>& more) {
        if (chosen) columns.insert(columns.end(), more.begin(), more.end());
    };
    add(choice.friction, friction_);
    add(choice.inertia, inertia_);
    add(choice.gravity, gravity_);
    add(choice.ripple, ripple_);
    add(choice.load, load_);
    return columns;
}

}  // namespace ripplenotch
