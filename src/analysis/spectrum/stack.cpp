// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/stack.hpp"

#include <algorithm>
#include <cmath>

#include "ripplenotch/analysis/humps.hpp"

namespace ripplenotch {

std::span<const double> places(const Sweep& sweep, Axis axis) {
    return axis == Axis::angle ? sweep.turns : sweep.time_s;
}

double length_of(const Sweep& sweep, Axis axis) {
    return axis == Axis::angle ? sweep.length_turns : sweep.duration_s;
}

PowerSpectrum Stack::tested() const { return {ratio, 1.0, resolution / spacing, first, averages, searched}; }

std::vector<SignificantPeak> Stack::peaks(double false_alarm) const {
    auto found = significant_peaks(tested(), false_alarm / tries_factor);
    for (SignificantPeak& peak : found) peak.false_alarm = std::min(1.0, peak.false_alarm * tries_factor);
    return found;
}

std::vector<SpectralHump> Stack::humps(const HumpRule& rule) const {
    std::vector<SpectralHump> humps;
    if (ratio.size() <= first) return humps;
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

}  // namespace ripplenotch
