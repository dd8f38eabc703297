// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/stack.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "ripplenotch/analysis/fourier.hpp"
#include "ripplenotch/analysis/line_test.hpp"

namespace ripplenotch {

namespace {

constexpr double used_cycles = 3.0;  // in a sweep: half a cycle beyond what the trend follows
// Half-overlapping Hann pieces count a little less than independent ones.
constexpr double overlap_correlation = 1.06;
constexpr double highest_stacked_order = 2560.0;  // order 8 of a ratio of 320, the highest in catalogues

}  // namespace

Stack stack_sweeps(std::span<const Sweep> sweeps) {
    Stack stack;
    double longest = 0.0, weights = 0.0, lengths = 0.0, highest = 0.0;
    const auto top = [](const Sweep& sweep) {
        return std::min(highest_stacked_order, 180.0 * sweep.rate_hz / std::max(sweep.fast_deg_s, 1e-9));
    };
    for (const Sweep& sweep : sweeps) {
        if (sweep.rest()) continue;
        longest = std::max(longest, sweep.length_turns);
        weights += sweep.effective_samples();
        lengths += sweep.effective_samples() * sweep.length_turns;
        highest = std::max(highest, top(sweep));
    }
    if (!(longest > 0.0)) return stack;
    stack.spacing = 0.5 / longest;
    stack.resolution = hann_cell * weights / lengths;
    const auto bins = static_cast<std::size_t>(highest / stack.spacing) + 1;
    stack.first = bins;
    std::vector<double> weight(bins, 0.0), square = weight, power = weight, noise = weight;
    for (const Sweep& sweep : sweeps) {
        if (sweep.rest()) continue;
        const double cells = 1.0 / (sweep.length_turns * stack.spacing), own = sweep.effective_samples();
        const auto from = static_cast<std::size_t>(std::ceil(used_cycles * cells));
        const auto end = std::min(static_cast<std::size_t>(top(sweep) / stack.spacing) + 1, bins);
        if (from + 1 >= end) continue;
        std::vector<double> powers;
        for (const auto& sum : nonuniform_fourier(sweep.turns, sweep.value, stack.spacing, end))
            powers.push_back(4.0 * std::norm(sum) / (sweep.weight_sum * sweep.weight_sum));
        const std::vector<double> floor = noise_floor({powers, 1.0, hann_cell * cells, from});
        for (std::size_t k = from; k < end; ++k) {
            weight[k] += own;
            square[k] += own * own;
            power[k] += own * powers[k];
            noise[k] += own * floor[k];
        }
        stack.first = std::min(stack.first, from);
    }
    for (std::size_t k = 0; k < bins; ++k) {
        const double sum = std::max(weight[k], 1e-300);
        const bool seen = weight[k] > 0.0;
        stack.averages.push_back(seen ? std::max(1.0, sum * sum / square[k] / overlap_correlation) : 0.0);
        stack.amplitude_nm.push_back(std::sqrt(power[k] / sum));
        stack.floor_nm.push_back(std::sqrt(noise[k] / sum));
    }
    return stack;
}

}  // namespace ripplenotch
