// SPDX-License-Identifier: MIT
#include "analysis/motion/place_error.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "analysis/lines/excess_scatter.hpp"
#include "core/process/two_cores.hpp"
#include "ripplenotch/analysis/fourier.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr double clear_ratio = 6.0;      // of power over noise; below, a peak's own place is not near normal
constexpr std::size_t few_sweeps = 4;    // by hand: fewer are cut in parts, for a scatter
constexpr std::size_t parts_of_few = 3;  // the fewest with a scatter
constexpr std::size_t fewest_samples_for_error = 24;  // by hand

/// What one piece of motion says about a line near a place: slope and curvature of half its power over noise,
/// and the variance that noise gives the slope.
struct Opinion {
    double slope = 0.0, curve = 0.0, slope_variance = 0.0;
    double ratio = 0.0;  ///< power over noise
    double reach = 0.0;  ///< the width of its line

    [[nodiscard]] bool clear() const { return ratio > clear_ratio && curve < 0.0; }
    [[nodiscard]] double shift() const { return std::clamp(-slope / curve, -reach, reach); }
    [[nodiscard]] double variance() const { return slope_variance / (curve * curve); }
};

Opinion opinion_of(const Sweep& sweep, Axis axis, double noise, double place) {
    const auto at = places(sweep, axis);
    const FourierPoint sum = fourier_point(at, sweep.value, place);
    double weights = 0.0, first = 0.0, second = 0.0;
    for (std::size_t k = 0; k < at.size(); ++k) {
        weights += sweep.weight[k];
        first += sweep.weight[k] * at[k];
    }
    const double middle = first / weights;
    for (std::size_t k = 0; k < at.size(); ++k) {
        const double arm = sweep.weight[k] * (at[k] - middle);
        second += arm * arm;
    }
    Opinion opinion;
    opinion.ratio = std::norm(sum.value) / noise;
    opinion.slope = std::real(std::conj(sum.value) * sum.first) / noise;
    opinion.curve = (std::norm(sum.first) + std::real(std::conj(sum.value) * sum.second)) / noise;
    // Slope = Re(conj(X) X'). Noise of power N in X has N full_turn^2 sum w^2 (u - mean)^2 / sum w^2 in X',
    // half of it in phase with X.
    opinion.slope_variance =
        0.5 * std::max(0.0, opinion.ratio - 1.0) * full_turn * full_turn * second / sweep.weight_square_sum;
    opinion.reach = 1.0 / length_of(sweep, axis);
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

/// By what factor the opinions lie further apart than their own variances say.
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

}  // namespace

double noise_at(const Stack& stack, std::size_t sweep, double place) {
    const auto bin = static_cast<std::size_t>(std::lround(std::max(0.0, place / stack.spacing)));
    const auto& floors = stack.floors[sweep];
    return bin < floors.size() ? static_cast<double>(floors[bin]) : 0.0;
}

bool are_long(std::span<const Sweep> sweeps) {
    constexpr std::size_t long_samples = 20'000;  // by hand: a third of a millisecond at one place
    std::size_t samples = 0;
    for (const Sweep& sweep : sweeps) samples += sweep.value.size();
    return samples > long_samples;
}

double place_error(std::span<const Sweep> sweeps, const Stack& stack, double place) {
    std::vector<std::size_t> asked;
    for (std::size_t i = 0; i < sweeps.size(); ++i) {
        if (noise_at(stack, i, place) > 0.0) asked.push_back(i);
    }
    std::vector<Opinion> whole(asked.size()), parts;
    on_two_cores(
        asked.size(),
        [&](std::size_t i) {
            whole[i] = opinion_of(sweeps[asked[i]], stack.axis, noise_at(stack, asked[i], place), place);
        },
        are_long(sweeps));
    double variance = 0.0, curve = 0.0;
    for (std::size_t i = 0; i < asked.size(); ++i) {
        const double weight = stack.sweep_weights[asked[i]];
        variance += weight * weight * whole[i].slope_variance;
        curve += weight * whole[i].curve;
        if (sweeps.size() < few_sweeps)
            add_parts(sweeps[asked[i]], stack.axis, noise_at(stack, asked[i], place), place, parts);
    }
    if (!(curve < 0.0) || !(variance > 0.0)) return stack.resolution;
    const double error = std::sqrt(variance) / -curve;
    return std::min(error * std::max(disagreement(whole), disagreement(parts)), stack.resolution);
}

}  // namespace ripplenotch
