// SPDX-License-Identifier: MIT
#include "diagnose/case/noise_ground.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/functions/many_numbers.hpp"

namespace ripplenotch {

NoiseWave::NoiseWave(std::span<const double> where, double cycles)
    : cosine(where.size()), sine(where.size()) {
    std::vector<double> angle(where.size());
    for (std::size_t k = 0; k < angle.size(); ++k) angle[k] = 2.0 * std::numbers::pi * (cycles * where[k]);
    portable::phasors(angle, cosine, sine);
}

void add_wave(NoiseColumns& columns, const NoiseWave& wave) {
    columns.add(wave.cosine);
    columns.add(wave.sine);
}

namespace {

using NoiseRules = DiagnosisRules::NoiseRules;

// Cubic B-spline number i, at u in units of the distance of two, from the middle of the second on.
double spline(double u, std::size_t i) {
    const double d = std::abs(u - (static_cast<double>(i) - 1.0));
    if (d >= 2.0) return 0.0;
    return d < 1.0 ? (4.0 - 6.0 * d * d + 3.0 * d * d * d) / 6.0 : (2.0 - d) * (2.0 - d) * (2.0 - d) / 6.0;
}

// `count` cubic B-splines over [low, high] of what place_at(row) is, in rows that counts(row) lets in. At one
// place no more than four are not 0.
template <class Place, class Counts>
void add_splines(NoiseColumns& columns, const Case& c, std::size_t count, double low, double high,
                 const Place& place_at, const Counts& counts) {
    std::vector<std::vector<double>> splines(count, std::vector<double>(c.size(), 0.0));
    for (std::size_t k = 0; k < c.size(); ++k) {
        if (!counts(k)) continue;
        const double part = std::clamp((place_at(k) - low) / std::max(high - low, 1e-12), 0.0, 1.0);
        const double u = part * (static_cast<double>(count) - 3.0);
        const auto first = static_cast<std::size_t>(u);
        for (std::size_t i = first; i < std::min(first + 4, count); ++i) splines[i][k] = spline(u, i);
    }
    for (std::vector<double>& column : splines) columns.add(std::move(column));
}

void add_swelling_wave(NoiseColumns& columns, const NoiseWave& wave, const std::vector<double>& size) {
    columns.add([&](std::size_t k) { return size[k] * wave.cosine[k]; });
    columns.add([&](std::size_t k) { return size[k] * wave.sine[k]; });
}

// tanh of the speed over the width of a step of direction, at every sample.
std::vector<double> unit_direction(const Case& c, const NoiseRules& rules) {
    const double width_deg_s = rules.step_part * c.moving_deg_s;
    std::vector<double> direction = c.motion.velocity_deg_s;
    for (double& value : direction) value /= width_deg_s;
    portable::many_tanh(direction);
    return direction;
}

// With what ripple may swell.
std::vector<std::vector<double>> swells_of(const Case& c, const NoiseRules& rules) {
    const Motion& m = c.motion;
    const double middle_s = 0.5 * (m.time_s.front() + m.time_s.back()), half_s = m.time_s.back() - middle_s;
    std::vector<std::vector<double>> swells(8);
    for (std::size_t k = 0; k < c.size(); ++k) {
        const double v = m.velocity_deg_s[k], elapsed = (m.time_s[k] - middle_s) / half_s;
        swells[0].push_back(std::abs(v));
        swells[1].push_back(v);
        swells[2].push_back(v * v);
        swells[4].push_back(std::abs(m.acceleration_deg_s2[k]));
        swells[5].push_back(elapsed);
        swells[6].push_back(elapsed * elapsed);
        swells[7].push_back(m.position_deg[k]);
    }
    swells[3] = unit_direction(c, rules);
    return swells;
}

// Ripple of the model and of its neighbourhood, each swelling with whatever the motion shows.
void add_ripple(NoiseColumns& columns, const Case& c, double ratio, const std::vector<double>& orders,
                const NoiseRules& rules) {
    const Motion& m = c.motion;
    const auto wave = [&](double cycles_per_turn) {
        return NoiseWave(m.position_deg, cycles_per_turn / 360.0);
    };
    std::vector<double> all = orders;
    for (double order = 1.0; order <= 6.0; ++order) {
        if (std::find(all.begin(), all.end(), order) == all.end()) all.push_back(order);
    }
    std::vector<NoiseWave> own;
    for (const double order : all) {
        NoiseWave found = wave(order * ratio);
        add_wave(columns, found);
        if (own.size() < orders.size()) own.push_back(std::move(found));
    }
    const auto swells = swells_of(c, rules);
    for (std::size_t i = 0; i < orders.size(); ++i) {
        for (const auto& swell : swells) add_swelling_wave(columns, own[i], swell);
        for (const double side : {-2.0, -1.0, 1.0, 2.0}) add_wave(columns, wave(orders[i] * ratio + side));
    }
}

void add_smooth(NoiseColumns& columns, const Case& c, const NoiseRules& rules) {
    const Motion& m = c.motion;
    const double width_deg_s = rules.step_part * c.moving_deg_s;
    const auto span = std::minmax_element(m.position_deg.begin(), m.position_deg.end());
    const double low_deg = *span.first, high_deg = *span.second;
    double fastest = 0.0;
    for (const double v : m.velocity_deg_s) fastest = std::max(fastest, std::abs(v));
    for (const double direction : {-1.0, 1.0}) {
        const auto moves = [&](std::size_t k) { return m.velocity_deg_s[k] * direction > width_deg_s; };
        const auto position = [&](std::size_t k) { return m.position_deg[k]; };
        add_splines(columns, c, rules.position_splines, low_deg, high_deg, position, moves);
        // Closer where it is slow: friction changes most there.
        const auto speed = [&](std::size_t k) { return std::sqrt(std::abs(m.velocity_deg_s[k])); };
        add_splines(columns, c, rules.speed_splines, 0.0, std::sqrt(fastest), speed, moves);
    }
    add_splines(
        columns, c, rules.time_splines, m.time_s.front(), m.time_s.back(),
        [&](std::size_t k) { return m.time_s[k]; }, [](std::size_t) { return true; });
    columns.add([&](std::size_t k) { return m.acceleration_deg_s2[k]; });
    columns.add([&](std::size_t k) { return std::abs(m.acceleration_deg_s2[k]); });
    const std::vector<double> direction = unit_direction(c, rules);
    columns.add([&](std::size_t k) { return direction[k]; });
    columns.add([&](std::size_t k) { return std::abs(m.acceleration_deg_s2[k]) * direction[k]; });
}

}  // namespace

NoiseColumns& NoiseGround::columns(const Case& looked_at, const StatedRipple& ripple,
                                   const NoiseRules& rules) {
    if (columns_ && ripple.orders == ripple_.orders && ripple.ratio == ripple_.ratio) {
        columns_->cut(count_);
        return *columns_;
    }
    ripple_ = ripple;
    columns_.emplace(looked_at.use);
    add_ripple(*columns_, looked_at, ripple.ratio.value(), ripple.orders, rules);
    add_smooth(*columns_, looked_at, rules);
    count_ = columns_->count();
    return *columns_;
}

}  // namespace ripplenotch
