// SPDX-License-Identifier: MIT
// The line test for spectra of some ten cells, as short sweeps have: no room for a running floor.

#include <algorithm>
#include <cmath>

#include "analysis/shared_limits.hpp"
#include "ripplenotch/analysis/line_test.hpp"

namespace ripplenotch {
namespace {

constexpr double lobe_cells = 2.0;         // a Hann line's main lobe
constexpr double fewest_beside = 1.5;      // cells beyond the guard on each side
constexpr double median_knowledge = 0.48;  // of a mean's: exceedance() counts cells behind a median

double mean(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
}

}  // namespace

std::vector<SignificantPeak> significant_peaks_of_few_cells(const PowerSpectrum& spectrum,
                                                            double false_alarm) {
    std::vector<SignificantPeak> peaks;
    const auto& power = spectrum.power;
    const auto guard = static_cast<std::size_t>(std::ceil(lobe_cells * spectrum.bins_per_cell));
    const auto beside = static_cast<std::size_t>(std::ceil(fewest_beside * spectrum.bins_per_cell));
    if (power.size() < spectrum.first + 2 * (guard + beside)) return peaks;
    const double tries =
        tries_per_cell * static_cast<double>(power.size() - spectrum.first) / spectrum.bins_per_cell;
    const auto at = [&](std::size_t bin) { return power.begin() + static_cast<std::ptrdiff_t>(bin); };
    for (std::size_t k = spectrum.first + guard + beside; k + guard + beside < power.size(); ++k) {
        if (power[k] < power[k - 1] || power[k] <= power[k + 1]) continue;
        const std::vector<double> below(at(spectrum.first), at(k - guard));
        const std::vector<double> above(at(k + guard + 1), power.end());
        std::vector<double> around = below;
        around.insert(around.end(), above.begin(), above.end());
        // Means, not medians: they know twice as much from so few cells. The louder side counts, since the
        // spectrum may fall steeply.
        const double local = std::max(mean(below), mean(above));
        const double cells = static_cast<double>(around.size()) / spectrum.bins_per_cell / median_knowledge;
        if (!(local > 0.0)) continue;
        const double chance = std::min(1.0, tries * exceedance({.ratio = power[k] / local,
                                                                .averages = spectrum.averages_at(k),
                                                                .cells = cells}));
        if (chance <= false_alarm) peaks.push_back({k, local, chance});
    }
    return peaks;
}

}  // namespace ripplenotch
