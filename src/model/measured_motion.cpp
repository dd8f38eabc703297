// SPDX-License-Identifier: MIT
#include "ripplenotch/model/measured_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t coefficients = 4;  // of a cubic
constexpr std::size_t fewest = 5;        // samples that a cubic is fitted to

// A rest: speeds within so many standard deviations of their noise, for so many smoothing windows. Nothing
// that moves faster than the last of these rests, however noisy the log.
constexpr double rest_deviations = 4.5, rest_windows = 3.0, most_at_rest_deg_s = 0.5;

struct Window {
    std::size_t first, end;  ///< samples [first, end)
};

// Solves the normal equations by elimination; the matrix is symmetric and positive definite, so that no
// pivoting is needed.
std::array<double, coefficients> solve(std::array<std::array<double, coefficients + 1>, coefficients> m) {
    for (std::size_t i = 0; i < coefficients; ++i) {
        for (std::size_t row = i + 1; row < coefficients; ++row) {
            const double factor = m[row][i] / m[i][i];
            for (std::size_t c = i; c <= coefficients; ++c) m[row][c] -= factor * m[i][c];
        }
    }
    std::array<double, coefficients> x{};
    for (std::size_t i = coefficients; i-- > 0;) {
        double sum = m[i][coefficients];
        for (std::size_t c = i + 1; c < coefficients; ++c) sum -= m[i][c] * x[c];
        x[i] = sum / m[i][i];
    }
    return x;
}

// Value and slope at sample k of the cubic through a window, in units of the signal and per second.
std::pair<double, double> cubic_at(const TraceView& log, std::size_t k, Window window) {
    const double reach_s =
        std::max(log.time_s[window.end - 1] - log.time_s[k], log.time_s[k] - log.time_s[window.first]);
    std::array<double, 2 * coefficients - 1> moments{};
    std::array<double, coefficients> right{};
    for (std::size_t j = window.first; j < window.end; ++j) {
        const double u = (log.time_s[j] - log.time_s[k]) / reach_s;
        double power = 1.0;
        for (std::size_t p = 0; p < moments.size(); ++p, power *= u) {
            moments[p] += power;
            if (p < coefficients) right[p] += power * log.velocity_deg_s[j];
        }
    }
    std::array<std::array<double, coefficients + 1>, coefficients> matrix{};
    for (std::size_t row = 0; row < coefficients; ++row) {
        for (std::size_t c = 0; c < coefficients; ++c) matrix[row][c] = moments[row + c];
        matrix[row][coefficients] = right[row];
    }
    const auto x = solve(matrix);
    return {x[0], x[1] / reach_s};
}

void check(const TraceView& log) {
    if (log.size() < fewest) {
        raise<DataError>("the log has {} rows; a motion is measured from at least {}", log.size(), fewest);
    }
    if (!std::isfinite(log.time_s.front())) raise<DataError>("the log has no time; give its --sample-rate");
    for (std::size_t k = 1; k < log.size(); ++k) {
        if (log.time_s[k] > log.time_s[k - 1]) continue;
        raise<DataError>("time goes from {} to {} s after row {}; a motion needs times that increase",
                         shortest(log.time_s[k - 1]), shortest(log.time_s[k]), k);
    }
}

std::vector<double> integrated(const TraceView& log) {
    std::vector<double> position_deg(log.size(), 0.0);
    for (std::size_t k = 1; k < log.size(); ++k) {
        position_deg[k] = position_deg[k - 1] + 0.5 * (log.time_s[k] - log.time_s[k - 1]) *
                                                    (log.velocity_deg_s[k] + log.velocity_deg_s[k - 1]);
    }
    return position_deg;
}

// Speeds that cannot be told from zero for long enough are a rest: there the joint has neither speed nor
// acceleration, and noise must not look like a motion to and fro.
void hold_rests(const TraceView& log, Seconds smoothing, double samples_in_window, Motion& motion) {
    double squares = 0.0;
    for (std::size_t k = 0; k < log.size(); ++k) {
        const double off = log.velocity_deg_s[k] - motion.velocity_deg_s[k];
        squares += off * off;
    }
    // Variance of the middle of a cubic fitted to n samples: 9 / (4 n) of one sample's.
    const double noise_deg_s =
        std::sqrt(squares / static_cast<double>(log.size()) * 2.25 / samples_in_window);
    const double still_deg_s = std::min(rest_deviations * noise_deg_s, most_at_rest_deg_s);
    for (std::size_t first = 0; first < log.size();) {
        std::size_t end = first;
        while (end < log.size() && std::abs(motion.velocity_deg_s[end]) <= still_deg_s) ++end;
        if (end > first && log.time_s[end - 1] - log.time_s[first] >= rest_windows * smoothing.value()) {
            const auto from = static_cast<std::ptrdiff_t>(first),
                       count = static_cast<std::ptrdiff_t>(end - first);
            std::fill_n(motion.velocity_deg_s.begin() + from, count, 0.0);
            std::fill_n(motion.acceleration_deg_s2.begin() + from, count, 0.0);
        }
        first = std::max(end, first + 1);
    }
}

}  // namespace

Motion motion_along(const TraceView& log, Seconds smoothing) {
    check(log);
    Motion motion{.sample_rate = log.sample_rate,
                  .time_s = {log.time_s.begin(), log.time_s.end()},
                  .position_deg = {log.position_deg.begin(), log.position_deg.end()},
                  .velocity_deg_s = std::vector<double>(log.size()),
                  .acceleration_deg_s2 = std::vector<double>(log.size())};
    if (!log.has_position()) motion.position_deg = integrated(log);
    // A millionth of a sample wider, so that rounding of the times does not decide which samples are in.
    const double half_s = 0.5 * smoothing.value() + 1e-6 / log.sample_rate.value();
    std::size_t first = 0, end = 0;
    for (std::size_t k = 0; k < log.size(); ++k) {
        while (log.time_s[k] - log.time_s[first] > half_s) ++first;
        while (end < log.size() && log.time_s[end] - log.time_s[k] <= half_s) ++end;
        Window window{first, end};
        if (window.end - window.first < fewest) {
            window.first = std::min(k - std::min<std::size_t>(k, fewest / 2), log.size() - fewest);
            window.end = window.first + fewest;
        }
        std::tie(motion.velocity_deg_s[k], motion.acceleration_deg_s2[k]) = cubic_at(log, k, window);
    }
    const double in_window =
        std::max(smoothing.value() * log.sample_rate.value(), static_cast<double>(fewest));
    hold_rests(log, smoothing, in_window, motion);
    return motion;
}

}  // namespace ripplenotch
