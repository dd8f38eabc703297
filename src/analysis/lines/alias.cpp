// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/alias.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>

#include "ripplenotch/analysis/fourier.hpp"
#include "ripplenotch/analysis/sweeps.hpp"

namespace ripplenotch {

namespace {

constexpr std::size_t most_samples = 20000;  // chosen, not derived: bounds the time
constexpr std::size_t most_folds = 40;       // chosen, not derived: bounds the time
constexpr double most_grid = 300.0;          // chosen, not derived: bounds the time

double rate_in_orders(Hertz rate, DegPerSec speed) {
    return 360.0 * rate.value() / std::max(std::abs(speed.value()), 1e-9);
}

/// Sweeps that vouch for the seen order, with the noise there; images share it.
struct Witness {
    const Sweep* sweep = nullptr;
    double noise = 0.0;
};

std::vector<Witness> witnesses_of(std::span<const Sweep> sweeps, const Stack& angle, double seen) {
    const auto bin = static_cast<std::size_t>(std::lround(std::max(0.0, seen / angle.spacing)));
    std::vector<std::size_t> by_weight(sweeps.size());
    std::iota(by_weight.begin(), by_weight.end(), std::size_t{0});
    std::stable_sort(by_weight.begin(), by_weight.end(), [&](std::size_t a, std::size_t b) {
        return angle.sweep_weights[a] > angle.sweep_weights[b];
    });
    std::vector<Witness> witnesses;
    std::size_t samples = 0;
    for (const std::size_t i : by_weight) {
        const auto& floors = angle.floors[i];
        if (bin >= floors.size() || floors[bin] <= 0.0F) continue;
        samples += sweeps[i].turns.size();
        if (samples > most_samples) break;
        witnesses.push_back({&sweeps[i], static_cast<double>(floors[bin])});
    }
    return witnesses;
}

double gain_of_comb(std::span<const Witness> witnesses, double order) {
    double most = 0.0, gain = 0.0;
    for (const Witness& witness : witnesses) {
        const double weight = witness.sweep->effective_samples();
        const double power =
            std::norm(fourier_point(witness.sweep->turns, witness.sweep->value, order).value);
        most = std::max(most, weight);
        gain += weight * (power / witness.noise - 1.0);
    }
    return most > 0.0 ? gain / most : 0.0;
}

/// Largest gain between two orders: a grid of a third of a resolution, then halved steps around its best.
Fold best_between(std::span<const Witness> witnesses, double from, double to, double step) {
    step = std::max(step, (to - from) / most_grid);
    Fold best{0.5 * (from + to), -1e300};
    for (double at = std::max(from, step); at <= to; at += step) {
        const double gain = gain_of_comb(witnesses, at);
        if (gain > best.gain) best = {at, gain};
    }
    for (double reach = step / 2.0; reach > step / 200.0; reach /= 2.0) {
        for (const double at : {best.order_output - reach, best.order_output + reach}) {
            const double gain = gain_of_comb(witnesses, at);
            if (gain > best.gain) best = {at, gain};
        }
    }
    return best;
}

}  // namespace

std::vector<Fold> folds_of(std::span<const Sweep> sweeps, const Stack& angle, const SeenOrder& order) {
    const auto [seen, highest] = order;
    const std::vector<Witness> witnesses = witnesses_of(sweeps, angle, seen);
    std::vector<Fold> folds;
    if (witnesses.empty()) return folds;
    const Sweep& heaviest = *witnesses.front().sweep;
    const double slow = rate_in_orders(Hertz(heaviest.rate_hz), DegPerSec(heaviest.slow_deg_s));
    const double quick = rate_in_orders(Hertz(heaviest.rate_hz), DegPerSec(heaviest.quick_deg_s));
    const double step = 0.5 / heaviest.length_turns, reach = 6.0 * step;
    for (double k = 1.0; k * quick - seen <= highest && folds.size() < most_folds; k += 1.0) {
        for (const double side : {-1.0, 1.0}) {
            const double from = k * quick + side * seen - reach, to = k * slow + side * seen + reach;
            // An image that falls on the seen order itself carries no information.
            const bool on_itself = from < seen + 4.0 * angle.resolution && to > seen - 4.0 * angle.resolution;
            if (from < highest && !on_itself) folds.push_back(best_between(witnesses, from, to, step));
        }
    }
    std::stable_sort(folds.begin(), folds.end(),
                     [](const Fold& a, const Fold& b) { return a.gain > b.gain; });
    return folds;
}

}  // namespace ripplenotch
