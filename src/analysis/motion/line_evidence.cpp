// SPDX-License-Identifier: MIT
#include "analysis/motion/line_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "core/process/two_cores.hpp"
#include "ripplenotch/analysis/fourier.hpp"
#include "ripplenotch/analysis/line_test.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr double clear_ratio = 6.0;      // power over noise; below, a peak's own position is not near normal
constexpr std::size_t few_sweeps = 4;    // chosen, not derived: fewer are cut in parts, for a scatter
constexpr std::size_t parts_of_few = 3;  // the fewest with a scatter
constexpr std::size_t fewest_samples_for_error = 24;  // chosen, not derived

/// The information of one piece of motion on a line near a position: slope and curvature of half its power
/// over noise, and the variance of the slope under noise.
struct Opinion {
    double slope = 0.0, curve = 0.0, slope_variance = 0.0;
    double ratio = 0.0;  ///< power over noise
    double reach = 0.0;  ///< the width of its line

    [[nodiscard]] bool clear() const { return ratio > clear_ratio && curve < 0.0; }
    [[nodiscard]] double shift() const { return std::clamp(-slope / curve, -reach, reach); }
    [[nodiscard]] double variance() const { return slope_variance / (curve * curve); }
};

/// Without the variance of the slope.
Opinion seen_at(const Sweep& sweep, Axis axis, double noise, double place) {
    const FourierPoint sum = fourier_point(places(sweep, axis), sweep.value, place);
    Opinion seen;
    seen.ratio = std::norm(sum.value) / noise;
    seen.slope = std::real(std::conj(sum.value) * sum.first) / noise;
    seen.curve = (std::norm(sum.first) + std::real(std::conj(sum.value) * sum.second)) / noise;
    seen.reach = 1.0 / length_of(sweep, axis);
    return seen;
}

Opinion opinion_of(const Sweep& sweep, Axis axis, double noise, double place) {
    const auto at = places(sweep, axis);
    double weights = 0.0, first = 0.0, second = 0.0;
    for (std::size_t k = 0; k < at.size(); ++k) {
        weights += sweep.weight[k];
        first += sweep.weight[k] * at[k];
    }
    for (std::size_t k = 0; k < at.size(); ++k) {
        const double arm = sweep.weight[k] * (at[k] - first / weights);
        second += arm * arm;
    }
    Opinion opinion = seen_at(sweep, axis, noise, place);
    // Slope = Re(conj(X) X'). Noise of power N in X has N full_turn^2 sum w^2 (u - mean)^2 / sum w^2 in X',
    // half of it in phase with X.
    opinion.slope_variance =
        0.5 * std::max(0.0, opinion.ratio - 1.0) * full_turn * full_turn * second / sweep.weight_square_sum;
    return opinion;
}

/// Thirds of a sweep, each with a window of its own.
void add_parts(const Sweep& sweep, Axis axis, double noise, double place, std::vector<Opinion>& opinions) {
    const std::size_t n = sweep.turns.size();
    for (std::size_t part = 0; part < parts_of_few; ++part) {
        const std::size_t first = n * part / parts_of_few, end = n * (part + 1) / parts_of_few;
        if (end - first < fewest_samples_for_error) return;
        const Sweep piece = part_of(sweep, first, end - first);
        if (!(piece.weight_square_sum > 0.0)) continue;
        opinions.push_back(
            opinion_of(piece, axis, noise * piece.weight_square_sum / sweep.weight_square_sum, place));
    }
}

/// By what factor the estimates scatter more than their own variances explain.
double disagreement(std::span<const Opinion> opinions) {
    double top = 0.0, bottom = 0.0, count = 0.0;
    for (const Opinion& one : opinions) {
        if (!one.clear()) continue;
        top += one.shift() / one.variance();
        bottom += 1.0 / one.variance();
        count += 1.0;
    }
    if (count < 2.0) return 1.0;
    double squares = 0.0;
    for (const Opinion& one : opinions) {
        if (!one.clear()) continue;
        const double off = one.shift() - top / bottom;
        squares += off * off / one.variance();
    }
    return excess_scatter(squares, count - 1.0);
}

/// Standard error of the common shift, by leaving out one sweep after the other.
double jackknife_error(std::span<const Opinion> opinions) {
    const auto n = static_cast<double>(opinions.size());
    double slope = 0.0, curve = 0.0, sum = 0.0, squares = 0.0;
    for (const Opinion& one : opinions) {
        slope += one.slope;
        curve += one.curve;
    }
    for (const Opinion& left_out : opinions) {
        if (n < 2.0 || !(curve - left_out.curve < 0.0)) return 0.0;
        const double shift = -(slope - left_out.slope) / (curve - left_out.curve);
        sum += shift;
        squares += shift * shift;
    }
    return std::sqrt((n - 1.0) / n * std::max(0.0, squares - sum * sum / n));
}

}  // namespace

double place_error(std::span<const Sweep> sweeps, const LineNoise& noise, double place) {
    std::vector<Opinion> whole, parts;
    double variance = 0.0, curve = 0.0;
    for (std::size_t i = 0; i < sweeps.size(); ++i) {
        if (!(noise.power[i] > 0.0)) continue;
        whole.push_back(opinion_of(sweeps[i], noise.axis, noise.power[i], place));
        variance += whole.back().slope_variance;
        curve += whole.back().curve;
        if (sweeps.size() < few_sweeps) add_parts(sweeps[i], noise.axis, noise.power[i], place, parts);
    }
    if (!(curve < 0.0) || !(variance > 0.0)) return noise.resolution;
    const double error = std::sqrt(variance) / -curve;
    return std::min(
        std::max(error * std::max(disagreement(whole), disagreement(parts)), jackknife_error(whole)),
        noise.resolution);
}

namespace {

/// Slope, curve and power over noise of all sweeps together.
Opinion seen_in_all(std::span<const Sweep> sweeps, const LineNoise& noise, double place) {
    std::vector<Opinion> seen(sweeps.size());
    on_two_cores(sweeps.size(), [&](std::size_t i) {
        if (noise.power[i] > 0.0) seen[i] = seen_at(sweeps[i], noise.axis, noise.power[i], place);
    });
    Opinion all;
    for (const Opinion& one : seen) {
        all.slope += one.slope;
        all.curve += one.curve;
        all.ratio += one.ratio;
    }
    return all;
}

}  // namespace

double refined(std::span<const Sweep> sweeps, const LineNoise& noise, double start, double reach) {
    double place = start;
    for (int round = 0; round < 8; ++round) {
        const Opinion all = seen_in_all(sweeps, noise, place);
        if (!(all.curve < 0.0)) return place;
        const double next = std::clamp(place - all.slope / all.curve, start - reach, start + reach);
        const bool settled = std::abs(next - place) < 1e-7 * reach;
        place = next;
        if (settled) break;
    }
    return place;
}

double explained(std::span<const Sweep> sweeps, const LineNoise& noise, double place) {
    const auto used = std::count_if(noise.power.begin(), noise.power.end(), [](double n) { return n > 0.0; });
    return seen_in_all(sweeps, noise, place).ratio - static_cast<double>(used);
}

void measure(std::span<const Sweep> sweeps, const LineNoise& noise, double place,
             std::span<const std::complex<double>> amplitudes, MotionLine& line) {
    struct Sum {
        double weights = 0.0, power = 0.0, noise_power = 0.0, lengths = 0.0;
        std::complex<double> together;
        [[nodiscard]] double amplitude_nm() const {
            return weights > 0.0 ? std::sqrt(std::max(power - noise_power, 0.0) / weights) : 0.0;
        }
    };
    Sum moving, resting;
    line.by_speed.clear();
    for (std::size_t i = 0; i < sweeps.size(); ++i) {
        if (!(noise.power[i] > 0.0)) continue;
        const Sweep& sweep = sweeps[i];
        const double length = std::abs(amplitudes[i]);
        const double floor = 4.0 * noise.power[i] / (sweep.weight_sum * sweep.weight_sum);
        const double weight = sweep.effective_samples();
        Sum& sum = sweep.mean_deg_s == 0.0 ? resting : moving;
        sum.weights += weight;
        sum.power += weight * length * length;
        sum.noise_power += weight * floor;
        sum.together += weight * amplitudes[i];
        sum.lengths += weight * length;
        const double hz = noise.axis == Axis::angle ? place * std::abs(sweep.mean_deg_s) / 360.0 : place;
        line.by_speed.push_back({sweep.mean_deg_s, hz, length, length / std::sqrt(floor)});
    }
    const Sum& sum = resting.amplitude_nm() > moving.amplitude_nm() ? resting : moving;
    if (!(sum.weights > 0.0)) return;
    if (noise.axis == Axis::angle) {
        // For random phases, two sweeps reach this by chance less than half the time.
        constexpr double agreement = 0.7;
        if (sum.lengths > 0.0 && std::abs(sum.together) > agreement * sum.lengths)
            line.phase_deg = portable::arg(sum.together) * degrees_per_radian;
    }
    line.floor_nm = std::sqrt(sum.noise_power / sum.weights);
    line.amplitude_nm = sum.amplitude_nm();
    line.snr = line.amplitude_nm / line.floor_nm;
}

}  // namespace ripplenotch
