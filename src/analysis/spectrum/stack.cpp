// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/stack.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

#include "core/functions/many_numbers.hpp"
#include "core/process/two_cores.hpp"
#include "ripplenotch/analysis/fourier.hpp"
#include "ripplenotch/analysis/line_test.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

namespace {

constexpr std::size_t most_parts = 4;  // chosen, not derived: each holds five sums a bin
constexpr double overlap_correlation =
    1.06;  // half-overlapping Hann pieces count a little less than independent ones

constexpr double smeared_cells = 20.0;  // chosen, not derived
// Chosen, not derived: multiple of the sample rate at the highest speed.
constexpr double folds_searched = 2.5;
constexpr double used_cycles = 3.0;         // in a sweep: half a cycle beyond what the trend follows
constexpr double fewest_sweep_cells = 6.0;  // cells in a sweep's spectrum: a line's main lobe and four more

struct Reach {
    std::size_t first = 0, end = 0;  // bins
};

/// The speeds of all sweeps: lower and upper quartile of the slowest and of the quickest.
struct Speeds {
    double slow_deg_s = 1e300, quick_deg_s = 0.0;
};

/// The order at which the sample rate stands at the sweep's highest speed, and short of it: the motion, far
/// stronger than any line, folds to there.
double clear_of_motion(const Sweep& sweep) {
    return 0.8 * 360.0 * sweep.rate_hz / std::max(sweep.fast_deg_s, 1e-9);
}

/// Highest order that a sweep shows. At one speed, lines above half the sample rate fold onto others exactly.
/// When the speed changes so much, within sweeps or from one to another, that a folded line smears over many
/// resolutions, the sum over the measured angle gathers a line at its own order alone, whatever the sample
/// rate.
double highest_order(const Sweep& sweep, const Speeds& speeds) {
    const double per_turn = sweep.rate_hz * 360.0;
    const double smear =
        per_turn / std::max(speeds.slow_deg_s, 1e-9) - per_turn / std::max(speeds.quick_deg_s, 1e-9);
    const bool smears = smear > smeared_cells * hann_cell / sweep.length_turns;
    return smears ? folds_searched * per_turn / std::max(speeds.quick_deg_s, 1e-9)
                  : 0.5 * per_turn / std::max(sweep.slow_deg_s, 1e-9);
}

struct StackGrid {
    Axis axis = Axis::angle;
    double spacing = 0.0;
    std::size_t bins = 0;
    Speeds speeds;
};

Reach reach_of(const Sweep& sweep, const StackGrid& grid, const StackRule& rule) {
    const double length = length_of(sweep, grid.axis);
    if (!(length > 0.0)) return {};
    // Below the lowest line that is looked for, down to the trend: its noise on that side. Next to half the
    // sample rate a tone and its image are one, and noise is real: it scatters twice as much.
    const double lowest = used_cycles / length;
    const double highest = grid.axis == Axis::angle
                               ? std::min(rule.highest_order, highest_order(sweep, grid.speeds))
                               : 0.5 * sweep.rate_hz - hann_cell / length;
    const auto end = static_cast<std::size_t>(highest / grid.spacing) + 1;
    return {static_cast<std::size_t>(std::ceil(lowest / grid.spacing)), std::min(end, grid.bins)};
}

/// stack_sweeps in parts of the sweeps. The parts are the same on any number of threads, so the bytes are.
class Stacking {
  public:
    /// The sweeps and the rule must outlive it.
    Stacking(std::span<const Sweep> sweeps, Axis axis, const StackRule& rule);

    [[nodiscard]] std::size_t parts() const { return parts_.size(); }
    /// To be called for each part once, in any order.
    void run(std::size_t part);
    /// When all parts ran; the last call.
    [[nodiscard]] Stack stack();

  private:
    struct Part {
        std::size_t first = 0, end = 0;  ///< sweeps
        /// By bin: sums over the sweeps, as Stack has their means.
        std::vector<double> ratio, amplitude, floor, weight, square;
        std::size_t low = 0, high = 0;  ///< bins that a sweep reaches
    };
    void add(std::size_t sweep, Part& part);

    std::span<const Sweep> sweeps_;
    const StackRule& rule_;
    Stack stack_;
    std::size_t bins_ = 0;
    double slow_deg_s_ = 1e300, quick_deg_s_ = 0.0;  ///< quartiles of the slowest and the quickest sweep
    std::vector<Part> parts_;
};

Stacking::Stacking(std::span<const Sweep> sweeps, Axis axis, const StackRule& rule)
    : sweeps_(sweeps), rule_(rule) {
    stack_.axis = axis;
    double longest = 0.0, weights = 0.0, mean_length = 0.0, half_rate = 0.0;
    for (const Sweep& sweep : sweeps) {
        const double length = length_of(sweep, axis);
        const double weight = length > 0.0 ? sweep.effective_samples() : 0.0;
        longest = std::max(longest, length);
        weights += weight;
        mean_length += weight * length;
        half_rate = std::max(half_rate, 0.5 * sweep.rate_hz);
        stack_.sweep_weights.push_back(weight);
        if (sweep.rest()) continue;
        slow_deg_s_ = std::min(slow_deg_s_, sweep.slow_deg_s);
        quick_deg_s_ = std::max(quick_deg_s_, sweep.quick_deg_s);
    }
    if (!(longest > 0.0)) {
        stack_.sweep_weights.clear();
        return;
    }
    mean_length /= weights;
    stack_.spacing = 0.5 / longest;
    stack_.resolution = hann_cell / mean_length;
    const double highest = axis == Axis::angle ? rule.highest_order : half_rate;
    bins_ = static_cast<std::size_t>(highest / stack_.spacing) + 1;
    stack_.floors.resize(sweeps.size());
    const std::size_t parts = std::min(most_parts, sweeps.size());
    for (std::size_t part = 0; part < parts; ++part)
        parts_.push_back({.first = sweeps.size() * part / parts,
                          .end = sweeps.size() * (part + 1) / parts,
                          .ratio = {},
                          .amplitude = {},
                          .floor = {},
                          .weight = {},
                          .square = {},
                          .low = bins_});
}

void Stacking::run(std::size_t number) {
    Part& part = parts_[number];
    for (auto* sums : {&part.ratio, &part.amplitude, &part.floor, &part.weight, &part.square})
        sums->assign(bins_, 0.0);
    for (std::size_t sweep = part.first; sweep < part.end; ++sweep) add(sweep, part);
}

void Stacking::add(std::size_t number, Part& part) {
    const Sweep& sweep = sweeps_[number];
    Reach reach = reach_of(sweep, {stack_.axis, stack_.spacing, bins_, {slow_deg_s_, quick_deg_s_}}, rule_);
    auto& floors = stack_.floors[number];
    floors.assign(bins_, 0.0F);
    const double cell = hann_cell / (length_of(sweep, stack_.axis) * stack_.spacing);
    const auto too_few = [&] {
        return static_cast<double>(reach.end) < static_cast<double>(reach.first) + fewest_sweep_cells * cell;
    };
    if (too_few()) return;
    const auto sums = nonuniform_fourier(places(sweep, stack_.axis), sweep.value, stack_.spacing, reach.end);
    std::vector<double> power(reach.end);
    for (std::size_t k = 0; k < reach.end; ++k) power[k] = std::norm(sums[k]);
    std::vector<double> floor = noise_floor({power, 1.0, cell, reach.first});
    const auto clear = static_cast<std::size_t>(clear_of_motion(sweep) / stack_.spacing) + 1;
    if (stack_.axis == Axis::angle && reach.end > clear) {
        // The residual of the motion after the trend folds to around the sample rate, smeared over the cells
        // that the sweep's own speeds span there: unseen where it is weak.
        const std::size_t slow = std::min(reach.end, reach.first + static_cast<std::size_t>(2.0 * cell));
        const double motion =
            *std::max_element(power.begin(), power.begin() + static_cast<std::ptrdiff_t>(slow));
        const double per_turn = 360.0 * sweep.rate_hz;
        const double smeared =
            (per_turn / std::max(sweep.slow_deg_s, 1e-9) - per_turn / std::max(sweep.quick_deg_s, 1e-9)) *
            sweep.length_turns / hann_cell;
        constexpr double most_of_noise = 8.0;  // the largest of a few cells of noise, over their mean
        if (motion > std::max(most_of_noise, 0.5 * smeared) * floor[reach.end / 2]) {
            reach.end = std::min(reach.end, clear);
            if (too_few()) return;
            power.resize(reach.end);
            floor = noise_floor({power, 1.0, cell, reach.first});
        }
    }
    const double weight = stack_.sweep_weights[number];
    const double to_amplitude = 4.0 / (sweep.weight_sum * sweep.weight_sum);
    for (std::size_t k = reach.first; k < reach.end; ++k) {
        floors[k] = static_cast<float>(floor[k]);
        part.ratio[k] += weight * power[k] / floor[k];
        part.amplitude[k] += weight * power[k] * to_amplitude;
        part.floor[k] += weight * floor[k] * to_amplitude;
        part.weight[k] += weight;
        part.square[k] += weight * weight;
    }
    part.low = std::min(part.low, reach.first);
    part.high = std::max(part.high, reach.end);
}

Stack Stacking::stack() {
    if (parts_.empty()) return std::move(stack_);
    Part all = std::move(parts_.front());
    for (std::size_t i = 1; i < parts_.size(); ++i) {
        const Part& part = parts_[i];
        for (std::size_t k = part.low; k < part.high; ++k) {
            all.ratio[k] += part.ratio[k];
            all.amplitude[k] += part.amplitude[k];
            all.floor[k] += part.floor[k];
            all.weight[k] += part.weight[k];
            all.square[k] += part.square[k];
        }
        all.low = std::min(all.low, part.low);
        all.high = std::max(all.high, part.high);
    }
    stack_.first = std::min(all.low, bins_);
    const std::size_t end = std::min(std::max(all.low, all.high), bins_);
    for (auto* means : {&stack_.ratio, &stack_.averages, &stack_.amplitude_nm, &stack_.floor_nm})
        means->resize(end);
    for (std::size_t k = stack_.first; k < end; ++k) {
        // Bins that no sweep reaches (between sweeps of very different speed) read as noise.
        const double weight = all.weight[k];
        const bool used = weight > 0.0;
        stack_.ratio[k] = used ? all.ratio[k] / weight : 1.0;
        stack_.averages[k] =
            used ? std::max(1.0, weight * weight / all.square[k] / overlap_correlation) : 1.0;
        stack_.amplitude_nm[k] = used ? std::sqrt(all.amplitude[k] / weight) : 0.0;
        stack_.floor_nm[k] = used ? std::sqrt(all.floor[k] / weight) : 0.0;
    }
    return std::move(stack_);
}

}  // namespace

std::span<const double> places(const Sweep& sweep, Axis axis) {
    return axis == Axis::angle ? sweep.turns : sweep.time_s;
}

double length_of(const Sweep& sweep, Axis axis) {
    return axis == Axis::angle ? sweep.length_turns : sweep.duration_s;
}

Stack stack_sweeps(std::span<const Sweep> sweeps, Axis axis, const StackRule& rule) {
    Stacking stacking(sweeps, axis, rule);
    on_two_cores(stacking.parts(), [&](std::size_t part) { stacking.run(part); });
    return stacking.stack();
}

}  // namespace ripplenotch
