// SPDX-License-Identifier: MIT
#pragma once
// Is a peak of a power spectrum a line, or could noise have made it? One test for spectra in frequency and in
// order.

#include <cstddef>
#include <span>
#include <vector>

#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {

/// A spectrum of power whose noise, at each bin, is the mean of `averages` independent exponential variables
/// (chi-square with 2 * averages degrees of freedom) around a floor that varies slowly along the bins.
struct PowerSpectrum {
    std::span<const double> power;
    double averages = 1.0;
    double bins_per_cell =
        1.5;                ///< bins that carry one independent value (1.5 for a Hann window without padding)
    std::size_t first = 0;  ///< bins below are not used
    std::size_t searched = 0;  ///< bins below, if not below `first`, are noise for others, and not searched
};

/// Mean noise power at each bin: running median over about 40 cells to each side, turned into a mean by the
/// ratio of median and mean of that distribution (ln 2 for one average). Lines narrower than half the window
/// do not raise it.
[[nodiscard]] std::vector<double> noise_floor(const PowerSpectrum& spectrum);

struct SignificantPeak {
    std::size_t bin = 0;
    double floor = 0.0;        ///< mean noise power here: the larger of a near and a far estimate
    double false_alarm = 1.0;  ///< chance that noise gives a peak as high as this anywhere in the spectrum
};

/// Local maxima whose false_alarm is at most the one requested, in bin order. Each is compared with the
/// larger of two floors, 2 to 5 and 3 to 40 cells away: so the flank of a broad resonance is no line, and
/// neither is the noise inside a narrow one. The floor is estimated from few cells, which the test allows
/// for: the ratio follows an F distribution. Maxima with fewer than 4 cells around them are not tested.
/// `floor` is noise_floor(spectrum).
[[nodiscard]] std::vector<SignificantPeak> significant_peaks(const PowerSpectrum& spectrum,
                                                             std::span<const double> floor,
                                                             double false_alarm);

/// Efficiency of a median of exponential values as an estimate of their mean, relative to the mean of as
/// many: (ln 2)^2.
inline constexpr double median_efficiency = 0.48;

/// Power over a floor, of so many averages; the floor was itself estimated as well as by the mean of `cells`
/// independent cells.
struct PowerOverFloor {
    double ratio = 0.0, averages = 1.0, cells = 0.0;
};

/// The power over a floor, with the averages and cells of `noise`, that noise exceeds with this chance.
[[nodiscard]] double exceeded(double chance, PowerOverFloor noise);

/// Chance that noise exceeds that ratio.
[[nodiscard]] double exceedance(const PowerOverFloor& seen);

/// Smaller lines are not reported: a share of the torque's range, and in any case the rounding error of a
/// constant.
[[nodiscard]] double least_amplitude_nm(std::span<const TraceView> logs, double share);

/// Ratio of median to mean of a chi-square variable with 2 * averages degrees of freedom. Source: Choi 1994,
/// median of the gamma distribution.
[[nodiscard]] double median_over_mean(double averages);

/// Chance that chi-square with so many degrees of freedom is larger: Wilson and Hilferty's cube root, within
/// 1 % of the exact quantile.
[[nodiscard]] double chi_square_chance(double squares, double freedom);

/// By what factor errors are too small, when estimates of one value scatter about their weighted mean with
/// `squares` = sum (estimate - mean)^2 / variance on `freedom` degrees of freedom: sqrt(squares / freedom)
/// (Birge 1932), where chance gives such scatter less than once in a hundred times; else 1. An error that is
/// widened by every scatter above the mean one would cover too often, and one that is never widened too
/// seldom.
[[nodiscard]] double excess_scatter(double squares, double freedom);

}  // namespace ripplenotch
