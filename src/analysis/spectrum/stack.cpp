// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/stack.hpp"

#include <algorithm>
#include <cmath>

#include "ripplenotch/analysis/fourier.hpp"
#include "ripplenotch/analysis/humps.hpp"

namespace ripplenotch {
namespace {

constexpr double hann_cell = 1.5;  // bins of one over the length
constexpr double overlap_correlation =
    1.06;  // half-overlapping Hann pieces count a little less than independent ones

constexpr double smeared_cells = 20.0;  // by hand

struct Reach {
    std::size_t first = 0, end = 0;  // bins
};

/// Highest order that a sweep can vouch for. At one speed, lines above half the sample rate fold onto others
/// exactly; when the speed changes so much that a folded line smears over many resolutions, what stays sharp
/// is not folded. Not so near the sample rate itself, where the whole motion, far stronger than any line,
/// folds to.
double highest_order(const Sweep& sweep) {
    const double per_turn = sweep.rate_hz * 360.0;
    const double slow = std::max(sweep.slow_deg_s, 1e-9);
    const double smear = per_turn / slow - per_turn / std::max(sweep.quick_deg_s, 1e-9);
    const bool smears = smear > smeared_cells * hann_cell / sweep.length_turns;
    const double clear_of_motion = 0.8 * per_turn / std::max(sweep.fast_deg_s, 1e-9);
    return smears ? clear_of_motion : std::min(clear_of_motion, 0.5 * per_turn / slow);
}

Reach reach_of(const Sweep& sweep, Axis axis, double spacing, std::size_t bins, const StackRule& rule) {
    const bool angle = axis == Axis::angle;
    const double lowest =
        std::max(angle ? rule.lowest_order : rule.lowest_hz, rule.fewest_cycles / length_of(sweep, axis));
    const double highest = angle ? std::min(rule.highest_order, highest_order(sweep)) : 0.5 * sweep.rate_hz;
    const auto end = static_cast<std::size_t>(highest / spacing) + 1;
    return {static_cast<std::size_t>(std::ceil(lowest / spacing)), std::min(end, bins)};
}

}  // namespace

std::span<const double> places(const Sweep& sweep, Axis axis) {
    return axis == Axis::angle ? sweep.turns : sweep.time_s;
}

double length_of(const Sweep& sweep, Axis axis) {
    return axis == Axis::angle ? sweep.length_turns : sweep.duration_s;
}

PowerSpectrum Stack::tested() const { return {ratio, 1.0, resolution / spacing, first, averages}; }

std::vector<SignificantPeak> Stack::peaks(double false_alarm) const {
    auto found = few_cells ? significant_peaks_of_few_cells(tested(), false_alarm / tries_factor)
                           : significant_peaks(tested(), false_alarm / tries_factor);
    for (SignificantPeak& peak : found) peak.false_alarm = std::min(1.0, peak.false_alarm * tries_factor);
    return found;
}

std::vector<SpectralHump> Stack::humps(const HumpRule& rule) const {
    std::vector<SpectralHump> humps;
    if (few_cells || ratio.size() <= first) return humps;
    // Not over the running floor, which a hump as wide as its window would raise to its own height.
    std::vector<double> power(ratio.size());
    for (std::size_t k = 0; k < power.size(); ++k) power[k] = ratio[k] * floor_nm[k] * floor_nm[k];
    PowerSpectrum spectrum = tested();
    spectrum.power = power;
    for (const SignificantHump& found : significant_humps(spectrum, rule.false_alarm / tries_factor)) {
        if (static_cast<double>(found.first) * spacing < rule.lowest) continue;
        SpectralHump hump;
        double square = 0.0;
        std::size_t highest = found.first;
        for (std::size_t k = found.first; k < found.end; ++k) {
            square += 0.5 * (power[k] - found.floor) * spacing / resolution;
            if (amplitude_nm[k] > amplitude_nm[highest]) highest = k;
        }
        hump.from_hz = static_cast<double>(found.first) * spacing;
        hump.to_hz = static_cast<double>(found.end - 1) * spacing;
        hump.peak_hz = static_cast<double>(highest) * spacing;
        hump.peak_nm = amplitude_nm[highest];
        hump.rms_nm = std::sqrt(std::max(square, 0.0));
        hump.floor_nm = std::sqrt(found.floor);
        hump.false_alarm = std::min(1.0, found.false_alarm * tries_factor);
        humps.push_back(hump);
    }
    std::stable_sort(humps.begin(), humps.end(),
                     [](const SpectralHump& a, const SpectralHump& b) { return a.rms_nm > b.rms_nm; });
    return humps;
}

Stack stack_sweeps(std::span<const Sweep> sweeps, Axis axis, const StackRule& rule) {
    Stack stack;
    stack.axis = axis;
    stack.few_cells = rule.few_cells;
    double longest = 0.0, weights = 0.0, mean_length = 0.0, half_rate = 0.0;
    for (const Sweep& sweep : sweeps) {
        longest = std::max(longest, length_of(sweep, axis));
        weights += sweep.effective_samples();
        mean_length += sweep.effective_samples() * length_of(sweep, axis);
        half_rate = std::max(half_rate, 0.5 * sweep.rate_hz);
    }
    if (!(longest > 0.0)) return stack;
    mean_length /= weights;
    stack.spacing = 0.5 / longest;
    stack.resolution = hann_cell / mean_length;
    stack.tries_factor = longest / mean_length;
    const double highest = axis == Axis::angle ? rule.highest_order : half_rate;
    const auto bins = static_cast<std::size_t>(highest / stack.spacing) + 1;

    std::vector<double> total(bins, 0.0), square(bins, 0.0);
    for (auto* v : {&stack.ratio, &stack.averages, &stack.amplitude_nm, &stack.floor_nm})
        v->assign(bins, 0.0);
    std::size_t low = bins, high = 0;
    for (const Sweep& sweep : sweeps) {
        const Reach reach = reach_of(sweep, axis, stack.spacing, bins, rule);
        stack.sweep_weights.push_back(sweep.effective_samples());
        auto& floors = stack.floors.emplace_back(bins, 0.0F);
        const double cell = hann_cell / (length_of(sweep, axis) * stack.spacing);
        if (static_cast<double>(reach.end) < static_cast<double>(reach.first) + 10.0 * cell) continue;
        const auto sums = nonuniform_fourier(places(sweep, axis), sweep.value, stack.spacing, reach.end);
        std::vector<double> power(reach.end);
        for (std::size_t k = 0; k < reach.end; ++k) power[k] = std::norm(sums[k]);
        const std::vector<double> floor = noise_floor({power, 1.0, cell, reach.first, {}});
        const double weight = stack.sweep_weights.back();
        const double to_amplitude = 4.0 / (sweep.weight_sum * sweep.weight_sum);
        for (std::size_t k = reach.first; k < reach.end; ++k) {
            floors[k] = static_cast<float>(floor[k]);
            stack.ratio[k] += weight * power[k] / floor[k];
            stack.amplitude_nm[k] += weight * power[k] * to_amplitude;
            stack.floor_nm[k] += weight * floor[k] * to_amplitude;
            total[k] += weight;
            square[k] += weight * weight;
        }
        low = std::min(low, reach.first);
        high = std::max(high, reach.end);
    }
    high = std::max(low, high);
    stack.first = std::min(low, bins);
    for (auto* v : {&stack.ratio, &stack.averages, &stack.amplitude_nm, &stack.floor_nm})
        v->resize(std::min(high, bins));
    for (std::size_t k = stack.first; k < stack.ratio.size(); ++k) {
        // Bins that no sweep reaches (between sweeps of very different speed) read as noise.
        const bool used = total[k] > 0.0;
        stack.ratio[k] = used ? stack.ratio[k] / total[k] : 1.0;
        stack.averages[k] = used ? std::max(1.0, total[k] * total[k] / square[k] / overlap_correlation) : 1.0;
        stack.amplitude_nm[k] = used ? std::sqrt(stack.amplitude_nm[k] / total[k]) : 0.0;
        stack.floor_nm[k] = used ? std::sqrt(stack.floor_nm[k] / total[k]) : 0.0;
    }
    return stack;
}

}  // namespace ripplenotch
