// SPDX-License-Identifier: MIT
#include "diagnose/case/band_gaps.hpp"

#include <array>
#include <cmath>
#include <complex>

#include "ripplenotch/analysis/fourier.hpp"

namespace ripplenotch {
namespace {

constexpr std::array edges_hz = {1.0, 10.0};

// rms in each band.
std::array<double, 3> rms_by_band(std::span<const double> values, Hertz sample_rate, bool with_mean) {
    std::vector<double> finite(values.begin(), values.end());
    for (double& value : finite) value = std::isfinite(value) ? value : 0.0;
    const auto sums = real_fourier(finite);
    const auto samples = static_cast<double>(finite.size());
    std::array<double, 3> bands{};
    for (std::size_t cell = with_mean ? 0 : 1; cell < sums.size(); ++cell) {
        const double hz = sample_rate.value() / samples * static_cast<double>(cell);
        const bool single = cell == 0 || 2 * cell == finite.size();
        bands[hz < edges_hz[0] ? 0 : (hz < edges_hz[1] ? 1 : 2)] +=
            (single ? 1.0 : 2.0) * std::norm(sums[cell]);
    }
    for (double& band : bands) band = std::sqrt(band) / samples;
    return bands;
}

}  // namespace

std::vector<BandGap> band_gaps(std::span<const double> torque_nm, std::span<const double> beside_given_nm,
                               std::span<const double> after_nm, Hertz sample_rate) {
    const auto torque = rms_by_band(torque_nm, sample_rate, false),
               beside = rms_by_band(beside_given_nm, sample_rate, true),
               after = rms_by_band(after_nm, sample_rate, true);
    std::vector<BandGap> bands = {
        {0.0, edges_hz[0], 0, 0, 0}, {edges_hz[0], edges_hz[1], 0, 0, 0}, {edges_hz[1], 0.0, 0, 0, 0}};
    for (std::size_t b = 0; b < bands.size(); ++b) {
        bands[b].torque_nm = torque[b];
        bands[b].beside_given_nm = beside[b];
        bands[b].after_nm = after[b];
    }
    return bands;
}

}  // namespace ripplenotch
