// SPDX-License-Identifier: MIT
#include "fleet/features/known_motion.hpp"

#include <algorithm>
#include <cmath>

#include "model/motion/local_motion.hpp"
#include "ripplenotch/core/median.hpp"
#include "ripplenotch/model/measured_motion.hpp"

namespace ripplenotch {
namespace {

constexpr double jump_deviations = 8.0, jump_part = 0.02;  // by hand
constexpr double least_over_noise = 5.0;                   // of accelerations, rms
constexpr double least_change = 1e-3;                      // of the speed within a window, or it is rounding

double sum_of_squares(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values) sum += value * value;
    return sum;
}

// sample_noise() with a median in the place of the rms, which jumps do not change.
double usual_noise(std::span<const double> values) {
    std::vector<double> fourth;
    for (std::size_t k = 4; k < values.size(); ++k)
        fourth.push_back(std::abs(values[k] - 4.0 * values[k - 1] + 6.0 * values[k - 2] -
                                  4.0 * values[k - 3] + values[k - 4]));
    const double usual = deviations_of_median * median_in(fourth) / std::sqrt(70.0);
    return usual > 0.0 ? usual : sample_noise(values);
}

// Part of `values` that no sum of the columns makes.
double part_beside(std::vector<double> values, std::vector<std::vector<double>> columns) {
    const double whole = sum_of_squares(values);
    for (std::size_t c = 0; c < columns.size(); ++c) {
        const double size = sum_of_squares(columns[c]);
        if (!(size > 0.0)) continue;
        const auto take_out = [&](std::vector<double>& from) {
            double along = 0.0;
            for (std::size_t k = 0; k < from.size(); ++k) along += columns[c][k] * from[k] / size;
            for (std::size_t k = 0; k < from.size(); ++k) from[k] -= along * columns[c][k];
        };
        take_out(values);
        for (std::size_t later = c + 1; later < columns.size(); ++later) take_out(columns[later]);
    }
    return whole > 0.0 ? sum_of_squares(values) / whole : 0.0;
}

}  // namespace

std::vector<unsigned char> rows_of_known_motion(const TraceView& log, const Motion& motion) {
    std::vector<double> speeds;
    for (const double speed : motion.velocity_deg_s) speeds.push_back(std::abs(speed));
    const double most_deg_s =
        std::max(jump_deviations * usual_noise(log.velocity_deg_s), jump_part * median_in(speeds));
    std::vector<unsigned char> known(log.size(), 1);
    const double window_s = default_smoothing.value();
    std::size_t from = 0, until = 0;  // `until`: rows before it are settled
    for (std::size_t k = 0; k < log.size(); ++k) {
        if (!(std::abs(log.velocity_deg_s[k] - motion.velocity_deg_s[k]) > most_deg_s)) continue;
        while (log.time_s[k] - log.time_s[from] > window_s) ++from;
        until = std::max(until, from);
        while (until < log.size() && log.time_s[until] - log.time_s[k] <= window_s) known[until++] = 0;
    }
    return known;
}

Accelerations accelerations_of(const TraceView& log, const Motion& motion,
                               const std::vector<unsigned char>& rows) {
    std::vector<double> acceleration, ones, direction, speed;
    for (std::size_t k = 0; k < rows.size(); ++k) {
        if (rows[k] == 0) continue;
        acceleration.push_back(motion.acceleration_deg_s2[k]);
        ones.push_back(1.0);
        speed.push_back(motion.velocity_deg_s[k]);
        direction.push_back(speed.back() > 0.0 ? 1.0 : speed.back() < 0.0 ? -1.0 : 0.0);
    }
    const double samples = std::max(1.0, default_smoothing.value() * log.sample_rate.value());
    // Of the slope of a cubic in the middle of so many samples.
    const double noise = usual_noise(log.velocity_deg_s) * log.sample_rate.value() *
                         std::sqrt(75.0 / (samples * samples * samples));
    const auto count = static_cast<double>(std::max<std::size_t>(acceleration.size(), 1));
    const double whole = sum_of_squares(acceleration) / count;
    const double beside = part_beside(acceleration, {ones, direction, speed});
    const double alone = std::sqrt(whole * beside), along = std::sqrt(whole * (1.0 - beside));
    const double rounding =
        least_change * std::sqrt(sum_of_squares(speed) / count) / default_smoothing.value();
    // What noise leaves along three columns, of accelerations that are alike for a window.
    const double noise_along = noise * std::sqrt(3.0 * samples / count);
    Accelerations found;
    found.known = alone > std::max(least_over_noise * noise, rounding);
    found.like_friction = !found.known && along > std::max(least_over_noise * noise_along, rounding);
    return found;
}

}  // namespace ripplenotch
