// SPDX-License-Identifier: MIT
#include "diagnose/case/line_spectrum.hpp"

#include <algorithm>
#include <complex>

#include "ripplenotch/analysis/fourier.hpp"

namespace ripplenotch {

double range_of(const LineSamples& samples) {
    const auto [low, high] = std::minmax_element(samples.where.begin(), samples.where.end());
    return std::max(*high - *low, 1e-9);
}

LineSpectrum spectrum_of(const LineSamples& samples, double spacing, std::size_t count) {
    LineSpectrum spectrum{spacing, {}};
    const auto sums = nonuniform_fourier(samples.where, samples.value, spacing, count);
    const double scale = 2.0 / static_cast<double>(samples.value.size());
    for (const auto& sum : sums) spectrum.power.push_back(std::norm(scale * sum));
    return spectrum;
}

LineSpectrum spectrum_of(const LineSamples& samples, double highest, const LineRules& rules) {
    const double spacing = 1.0 / (rules.oversampling * range_of(samples));
    return spectrum_of(
        samples, spacing,
        std::min(static_cast<std::size_t>(std::max(highest / spacing, 1.0)) + 1, rules.most_cells));
}

}  // namespace ripplenotch
