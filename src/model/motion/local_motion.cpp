// SPDX-License-Identifier: MIT
#include "model/motion/local_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/vectors/dot.hpp"

namespace ripplenotch {
namespace {

// Coefficients of the cubic in time over the window's reach, then the position in the middle.
constexpr std::size_t cubic = 4, unknowns = 5;
using Row = std::array<double, unknowns>;

Row velocity_row(double u) { return {1.0, u, u * u, u * u * u, 0.0}; }

Row position_row(double u, double reach_s) {
    const double s = u * reach_s;
    return {s, s * u / 2.0, s * u * u / 3.0, s * u * u * u / 4.0, reach_s};
}

void add(std::array<Row, unknowns>& moments, const Row& row, double weight) {
    for (std::size_t i = 0; i < unknowns; ++i) {
        for (std::size_t j = 0; j < unknowns; ++j) moments[i][j] += weight * row[i] * row[j];
    }
}

// Column `wanted` of the inverse, by elimination; the matrix is symmetric and positive definite, so that no
// pivoting is needed.
Row column_of_inverse(std::array<Row, unknowns> m, std::size_t n, std::size_t wanted) {
    Row x{};
    x[wanted] = 1.0;
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t row = i + 1; row < n; ++row) {
            const double factor = m[row][i] / m[i][i];
            for (std::size_t c = i; c < n; ++c) m[row][c] -= factor * m[i][c];
            x[row] -= factor * x[i];
        }
    }
    for (std::size_t i = n; i-- > 0;) {
        for (std::size_t c = i + 1; c < n; ++c) x[i] -= m[i][c] * x[c];
        x[i] /= m[i][i];
    }
    return x;
}

double product(const Row& a, const Row& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < unknowns; ++i) sum += a[i] * b[i];
    return sum;
}

// The sums that least squares need for a window: powers of its times, alone, with the velocities, and with
// the positions.
struct PowerSums {
    std::array<double, 9> time{};
    std::array<double, 4> velocity{};
    std::array<double, 5> position{};
};

// Written out, so that all sums stay in registers: no part of a motion costs as much.
template <bool both>
PowerSums power_sums(const TraceView& log, std::size_t k, SampleWindow window, double reach_s) {
    const double now_s = log.time_s[k], by_reach = 1.0 / reach_s, here_deg = both ? log.position_deg[k] : 0.0;
    double t1 = 0, t2 = 0, t3 = 0, t4 = 0, t5 = 0, t6 = 0, t7 = 0, t8 = 0;
    double v0 = 0, v1 = 0, v2 = 0, v3 = 0, p0 = 0, p1 = 0, p2 = 0, p3 = 0, p4 = 0;
    for (std::size_t j = window.first; j < window.end; ++j) {
        const double u = (log.time_s[j] - now_s) * by_reach, velocity = log.velocity_deg_s[j];
        const double u2 = u * u, u3 = u2 * u, u4 = u2 * u2;
        t1 += u;
        t2 += u2;
        t3 += u3;
        t4 += u4;
        t5 += u4 * u;
        t6 += u4 * u2;
        v0 += velocity;
        v1 += u * velocity;
        v2 += u2 * velocity;
        v3 += u3 * velocity;
        if constexpr (both) {
            const double position = log.position_deg[j] - here_deg;
            t7 += u4 * u3;
            t8 += u4 * u4;
            p0 += position;
            p1 += u * position;
            p2 += u2 * position;
            p3 += u3 * position;
            p4 += u4 * position;
        }
    }
    const auto count = static_cast<double>(window.end - window.first);
    return {{count, t1, t2, t3, t4, t5, t6, t7, t8}, {v0, v1, v2, v3}, {p0, p1, p2, p3, p4}};
}

// The same matrix as add() of every row makes, from sums of powers.
std::array<Row, unknowns> moments_of(const PowerSums& sums, double by_velocity, double by_position) {
    std::array<Row, unknowns> moments{};
    for (std::size_t i = 0; i < cubic; ++i) {
        const auto above_i = static_cast<double>(i + 1);
        for (std::size_t j = 0; j < cubic; ++j)
            moments[i][j] = by_velocity * sums.time[i + j] +
                            by_position * sums.time[i + j + 2] / (above_i * static_cast<double>(j + 1));
        moments[i][cubic] = moments[cubic][i] = by_position * sums.time[i + 1] / above_i;
    }
    moments[cubic][cubic] = by_position * sums.time[0];
    return moments;
}

// Times that are a sample apart within a millionth.
bool is_uniform(const TraceView& log) {
    const double step_s = (log.time_s.back() - log.time_s.front()) / static_cast<double>(log.size() - 1);
    for (std::size_t k = 1; k < log.size(); ++k) {
        if (std::abs(log.time_s[k] - log.time_s[k - 1] - step_s) > 1e-6 * step_s) return false;
    }
    return true;
}

}  // namespace

LocalFit::LocalFit(const TraceView& log, MotionNoise noise)
    : log_(log), noise_(noise), uniform_(is_uniform(log)) {}

void LocalFit::weigh(std::size_t k, SampleWindow window) {
    const bool as_before = before_ == k - window.first && after_ == window.end - k;
    if (as_before) return;
    before_ = k - window.first;
    after_ = window.end - k;
    const double now_s = log_.time_s[k];
    const double reach_s = std::max(log_.time_s[window.end - 1] - now_s, now_s - log_.time_s[window.first]);
    const bool both = noise_.position_deg > 0.0;
    const double by_velocity = 1.0 / (noise_.velocity_deg_s * noise_.velocity_deg_s);
    const double by_position = both ? 1.0 / (noise_.position_deg * noise_.position_deg) : 0.0;
    std::array<Row, unknowns> moments{};
    for (std::size_t j = window.first; j < window.end; ++j) {
        const double u = (log_.time_s[j] - now_s) / reach_s;
        add(moments, velocity_row(u), by_velocity);
        if (both) add(moments, position_row(u, reach_s), by_position);
    }
    const std::size_t n = both ? unknowns : cubic;
    const Row value = column_of_inverse(moments, n, 0), slope = column_of_inverse(moments, n, 1);
    variance_ = value[0];
    for (auto* weights : {&velocity_by_velocity_, &velocity_by_position_, &acceleration_by_velocity_,
                          &acceleration_by_position_})
        weights->clear();
    for (std::size_t j = window.first; j < window.end; ++j) {
        const double u = (log_.time_s[j] - now_s) / reach_s;
        velocity_by_velocity_.push_back(by_velocity * product(value, velocity_row(u)));
        acceleration_by_velocity_.push_back(by_velocity * product(slope, velocity_row(u)) / reach_s);
        if (!both) continue;
        velocity_by_position_.push_back(by_position * product(value, position_row(u, reach_s)));
        acceleration_by_position_.push_back(by_position * product(slope, position_row(u, reach_s)) / reach_s);
    }
}

void LocalFit::sum_up(std::size_t k, SampleWindow window) {
    if (summed_ == k && summed_end_ == window.end) return;
    summed_ = k;
    summed_end_ = window.end;
    const double now_s = log_.time_s[k];
    const double reach_s = std::max(log_.time_s[window.end - 1] - now_s, now_s - log_.time_s[window.first]);
    const bool both = noise_.position_deg > 0.0;
    const double by_velocity = 1.0 / (noise_.velocity_deg_s * noise_.velocity_deg_s);
    const double by_position = both ? reach_s * reach_s / (noise_.position_deg * noise_.position_deg) : 0.0;
    const PowerSums sums =
        both ? power_sums<true>(log_, k, window, reach_s) : power_sums<false>(log_, k, window, reach_s);
    const auto moments = moments_of(sums, by_velocity, by_position);
    const std::size_t n = both ? unknowns : cubic;
    const Row value = column_of_inverse(moments, n, 0), slope = column_of_inverse(moments, n, 1);
    variance_ = value[0];
    Row side{};
    for (std::size_t i = 0; i < cubic; ++i)
        side[i] = by_velocity * sums.velocity[i] +
                  by_position / reach_s * sums.position[i + 1] / static_cast<double>(i + 1);
    side[cubic] = by_position / reach_s * sums.position[0];
    found_ = {product(value, side), product(slope, side) / reach_s};
}

LocalMotion LocalFit::at(std::size_t k, SampleWindow window) {
    if (!uniform_) {
        sum_up(k, window);
        return found_;
    }
    weigh(k, window);
    const std::size_t count = window.end - window.first;
    const double* const velocity = log_.velocity_deg_s.data() + window.first;
    LocalMotion found{dot(velocity_by_velocity_.data(), velocity, count),
                      dot(acceleration_by_velocity_.data(), velocity, count)};
    if (noise_.position_deg == 0.0) return found;
    // From here, or digits of the whole angle would be lost.
    turned_deg_.resize(count);
    for (std::size_t j = 0; j < count; ++j)
        turned_deg_[j] = log_.position_deg[window.first + j] - log_.position_deg[k];
    found.velocity_deg_s += dot(velocity_by_position_.data(), turned_deg_.data(), count);
    found.acceleration_deg_s2 += dot(acceleration_by_position_.data(), turned_deg_.data(), count);
    return found;
}

double LocalFit::velocity_error(std::size_t k, SampleWindow window) {
    if (uniform_)
        weigh(k, window);
    else
        sum_up(k, window);
    return std::sqrt(variance_);
}

double sample_noise(std::span<const double> values) {
    if (values.size() < 5) return 0.0;
    double sum = 0.0;
    for (std::size_t k = 4; k < values.size(); ++k) {
        const double difference =
            values[k] - 4.0 * values[k - 1] + 6.0 * values[k - 2] - 4.0 * values[k - 3] + values[k - 4];
        sum += difference * difference;
    }
    // 70 is the sum of the squares of 1, -4, 6, -4, 1.
    return std::sqrt(sum / (70.0 * static_cast<double>(values.size() - 4)));
}

}  // namespace ripplenotch
