// SPDX-License-Identifier: MIT
#include "diagnose/case/noise_floor.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/many_numbers.hpp"
#include "diagnose/case/lines.hpp"
#include "diagnose/case/noise_columns.hpp"
#include "model/fit_coordinates.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/model/prediction.hpp"

namespace ripplenotch {
namespace {

using NoiseRules = DiagnosisRules::NoiseRules;

// Cubic B-spline number i of n over [low, high].
double spline(double x, double low, double high, std::size_t i, std::size_t n) {
    const double u =
        std::clamp((x - low) / std::max(high - low, 1e-12), 0.0, 1.0) * (static_cast<double>(n) - 3.0);
    const double d = std::abs(u - (static_cast<double>(i) - 1.0));
    if (d >= 2.0) return 0.0;
    return d < 1.0 ? (4.0 - 6.0 * d * d + 3.0 * d * d * d) / 6.0 : (2.0 - d) * (2.0 - d) * (2.0 - d) / 6.0;
}

// Cosine and sine of an angle in turns, at every sample.
struct Wave {
    template <class Function>
    Wave(std::size_t rows, const Function& turns_at) : cosine(rows), sine(rows) {
        std::vector<double> angle(rows);
        for (std::size_t k = 0; k < rows; ++k) angle[k] = 2.0 * std::numbers::pi * turns_at(k);
        portable::phasors(angle, cosine, sine);
    }
    std::vector<double> cosine, sine;
};

void add_wave(NoiseColumns& columns, const Wave& wave) {
    columns.add([&](std::size_t k) { return wave.cosine[k]; });
    columns.add([&](std::size_t k) { return wave.sine[k]; });
}

void add_wave(NoiseColumns& columns, const Wave& wave, const std::vector<double>& size) {
    columns.add([&](std::size_t k) { return size[k] * wave.cosine[k]; });
    columns.add([&](std::size_t k) { return size[k] * wave.sine[k]; });
}

// tanh of the speed over the width of a step of direction, at every sample.
std::vector<double> direction_of(const Case& c, const NoiseRules& rules) {
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
    swells[3] = direction_of(c, rules);
    return swells;
}

// Ripple of the model and of its neighbourhood, each swelling with whatever the motion shows.
void add_ripple(NoiseColumns& columns, const Case& c, double ratio, const std::vector<double>& orders,
                const NoiseRules& rules) {
    const Motion& m = c.motion;
    const auto wave = [&](double cycles_per_turn) {
        return Wave(c.size(), [&](std::size_t k) { return cycles_per_turn * m.position_deg[k] / 360.0; });
    };
    std::vector<double> all = orders;
    for (double order = 1.0; order <= 6.0; ++order) {
        if (std::find(all.begin(), all.end(), order) == all.end()) all.push_back(order);
    }
    std::vector<Wave> own;
    for (const double order : all) {
        Wave found = wave(order * ratio);
        add_wave(columns, found);
        if (own.size() < orders.size()) own.push_back(std::move(found));
    }
    const auto swells = swells_of(c, rules);
    for (std::size_t i = 0; i < orders.size(); ++i) {
        for (const auto& swell : swells) add_wave(columns, own[i], swell);
        for (const double side : {-2.0, -1.0, 1.0, 2.0}) add_wave(columns, wave(orders[i] * ratio + side));
    }
}

void add_smooth(NoiseColumns& columns, const Case& c, const NoiseRules& rules) {
    const Motion& m = c.motion;
    const double width_deg_s = rules.step_part * c.moving_deg_s;
    const std::size_t positions = rules.position_splines, speeds = rules.speed_splines,
                      times = rules.time_splines;
    const auto span = std::minmax_element(m.position_deg.begin(), m.position_deg.end());
    const double low_deg = *span.first, high_deg = *span.second;
    double fastest = 0.0;
    for (const double v : m.velocity_deg_s) fastest = std::max(fastest, std::abs(v));
    for (const double direction : {-1.0, 1.0}) {
        const auto moves = [&](std::size_t k) {
            return m.velocity_deg_s[k] * direction > width_deg_s ? 1.0 : 0.0;
        };
        for (std::size_t i = 0; i < positions; ++i) {
            columns.add([&](std::size_t k) {
                return moves(k) * spline(m.position_deg[k], low_deg, high_deg, i, positions);
            });
        }
        for (std::size_t i = 0; i < speeds; ++i) {  // closer where it is slow: friction changes most there
            columns.add([&](std::size_t k) {
                return moves(k) *
                       spline(std::sqrt(std::abs(m.velocity_deg_s[k])), 0.0, std::sqrt(fastest), i, speeds);
            });
        }
    }
    for (std::size_t i = 0; i < times; ++i)
        columns.add(
            [&](std::size_t k) { return spline(m.time_s[k], m.time_s.front(), m.time_s.back(), i, times); });
    columns.add([&](std::size_t k) { return m.acceleration_deg_s2[k]; });
    columns.add([&](std::size_t k) { return std::abs(m.acceleration_deg_s2[k]); });
    const std::vector<double> direction = direction_of(c, rules);
    columns.add([&](std::size_t k) { return direction[k]; });
    columns.add([&](std::size_t k) { return std::abs(m.acceleration_deg_s2[k]) * direction[k]; });
}

void add_slopes(NoiseColumns& columns, const Case& c, const Model& model, const Model& open) {
    const Coordinates coordinates(open, &model);
    std::vector<double> point;
    for (const Coordinate& coordinate : coordinates.list()) point.push_back(coordinate.start);
    const Prediction prediction(coordinates.at(point), c.motion);
    for (std::size_t i = 0; i < point.size(); ++i) {
        const auto slope = slope_nm(prediction, coordinates, point, i);
        columns.add([&](std::size_t k) { return slope[k]; });
    }
}

// Levinson's recursion; the order that the length of the log supports.
void color_of(const std::vector<double>& covariance, double samples, double lag_price, NoiseFloor& floor) {
    std::vector<double> a;  // e(k) = sum a[i] e(k-1-i) + white
    double variance = covariance[0];
    double best = samples * portable::log(variance);
    floor.color.clear();
    floor.white_nm = std::sqrt(variance);
    for (std::size_t p = 1; p < covariance.size(); ++p) {
        double reflection = covariance[p];
        for (std::size_t i = 0; i < a.size(); ++i) reflection -= a[i] * covariance[p - 1 - i];
        reflection /= variance;
        if (std::abs(reflection) >= 0.9999) break;
        std::vector<double> next = a;
        for (std::size_t i = 0; i < a.size(); ++i) next[i] -= reflection * a[a.size() - 1 - i];
        next.push_back(reflection);
        a = next;
        variance *= 1.0 - reflection * reflection;
        const double score = samples * portable::log(variance) + lag_price * static_cast<double>(p);
        if (score < best) {
            best = score;
            floor.color = a;
            floor.white_nm = std::sqrt(variance);
        }
    }
}

// rms of a stretch of the log that is quieter than most.
double quiet_rms(const std::vector<double>& left, const Case& c, const NoiseRules& rules) {
    const std::size_t length = std::max<std::size_t>(left.size() / rules.quiet_stretches, 50);
    std::vector<double> powers;
    for (std::size_t first = 0; first + length <= left.size(); first += length) {
        double sum = 0.0, count = 0.0;
        for (std::size_t k = first; k < first + length; ++k) {
            if (c.use[k] == 0) continue;
            sum += left[k] * left[k];
            count += 1.0;
        }
        if (count > 0.5 * static_cast<double>(length)) powers.push_back(sum / count);
    }
    if (powers.empty()) return 0.0;
    const auto middle =
        powers.begin() + static_cast<std::ptrdiff_t>(rules.quiet_part * static_cast<double>(powers.size()));
    std::nth_element(powers.begin(), middle, powers.end());
    return std::sqrt(*middle);
}

}  // namespace

double NoiseFloor::of_sums() const {
    double sum = 1.0;
    for (const double a : color) sum -= a;
    const double white_share = white_nm / rms_nm * (white_nm / rms_nm);
    return std::max(1.0, white_share / std::max(sum * sum, 1e-3));
}

namespace {

// Lines that stand out of what is about them are no noise: they become columns, two at a time.
std::vector<double> left_without_lines(NoiseColumns& columns, const Case& c,
                                       const std::vector<double>& torque_nm, const DiagnosisRules& rules) {
    std::vector<double> left = columns.left_of(torque_nm);
    for (std::size_t line = 0; line < rules.noise_floor.most_lines; line += 2) {
        const auto found = standing_out(c, left, rules.noise_floor.stands_out, 2, rules.lines);
        if (found.empty()) break;
        for (const ResidualLine& strong : found) {
            const auto& where = strong.by_angle ? c.motion.position_deg : c.motion.time_s;
            add_wave(columns, Wave(c.size(), [&](std::size_t k) { return strong.frequency * where[k]; }));
        }
        left = columns.left_of(torque_nm);
    }
    return left;
}

// At lags 0 to most_lags, over pairs of samples that both count.
std::vector<double> autocovariance(const std::vector<double>& left, const Case& c, std::size_t most_lags) {
    std::vector<double> covariance;
    for (std::size_t lag = 0; lag <= most_lags; ++lag) {
        double sum = 0.0, count = 0.0;
        for (std::size_t k = lag; k < left.size(); ++k) {
            if (c.use[k] == 0 || c.use[k - lag] == 0) continue;
            sum += left[k] * left[k - lag];
            count += 1.0;
        }
        covariance.push_back(sum / std::max(count, 1.0));
    }
    return covariance;
}

}  // namespace

NoiseFloor noise_floor(const Case& looked_at, const Model& model, const Model& open,
                       const DiagnosisRules& rules) {
    const Case& c = looked_at;
    std::vector<double> torque_nm = c.torque_nm;
    const auto predicted = predict_nm(model, c.motion);
    for (std::size_t k = 0; k < torque_nm.size(); ++k) torque_nm[k] -= predicted[k];
    const StatedRipple ripple = stated_ripple(model);
    NoiseColumns columns(c.use);
    add_slopes(columns, c, model, open);
    add_ripple(columns, c, ripple.ratio.value(), ripple.orders, rules.noise_floor);
    add_smooth(columns, c, rules.noise_floor);
    for (const Nuisance& nuisance : motion_errors(c, model, rules.recording))
        columns.add([&](std::size_t k) { return nuisance.torque_nm[k]; });
    const std::vector<double> left = left_without_lines(columns, c, torque_nm, rules);
    std::vector<double> covariance = autocovariance(left, c, rules.noise_floor.most_lags);
    const double samples = static_cast<double>(c.used());
    const double spent = samples / std::max(samples - static_cast<double>(columns.count()), 0.2 * samples);
    covariance[0] = std::max(covariance[0], 1e-24);
    NoiseFloor floor;
    color_of(covariance, samples, rules.noise_floor.lag_price, floor);
    floor.rms_nm = std::sqrt(covariance[0] * spent);
    floor.white_nm *= std::sqrt(spent);
    // What is loud in some stretches only is not noise but something that none of these columns can follow,
    // such as a resonance. Its colour would hide it.
    const double quiet_nm = quiet_rms(left, c, rules.noise_floor);
    if (quiet_nm > 0.0 && quiet_nm < rules.noise_floor.unsteady * floor.rms_nm)
        floor = {quiet_nm, quiet_nm, {}};
    return floor;
}

}  // namespace ripplenotch
