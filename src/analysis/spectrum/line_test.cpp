// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/line_test.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/spectrum/running_median.hpp"
#include "core/functions/many_numbers.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

// Maxima are looked for among correlated bins: about this many independent tries per cell. With it, white
// noise raises a false alarm somewhat less often than allowed.
constexpr double tries_per_cell = 1.6;

constexpr double guard_cells = 3.0;  // the main lobe of a Hann line and its first side lobe
constexpr double far_cells = 40.0;   // chosen, not derived: for a median that is known better
// Noise through a lightly damped resonance is only a few cells wide.
constexpr double inner_from_cells = 2.0, inner_to_cells = 5.0;
constexpr double fewest_cells = 4.0;  // chosen, not derived

/// Continued fraction of the incomplete beta function, by the modified method of Lentz.
double beta_fraction(double x, double a, double b) {
    constexpr double tiny = 1e-300;  // no division by 0, as Lentz has it
    double c = 1.0;
    double d = 1.0 - (a + b) * x / (a + 1.0);
    d = 1.0 / (std::abs(d) < tiny ? tiny : d);
    double fraction = d;
    for (int m = 1; m < 500; ++m) {
        const double even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        const double odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        for (const double term : {even, odd}) {
            d = 1.0 + term * d;
            d = 1.0 / (std::abs(d) < tiny ? tiny : d);
            c = 1.0 + term / c;
            c = std::abs(c) < tiny ? tiny : c;
            fraction *= d * c;
        }
        if (std::abs(d * c - 1.0) < 1e-13) break;
    }
    return fraction;
}

double incomplete_beta(double x, double a, double b) {
    if (x <= 0.0) return 0.0;
    if (x >= 1.0) return 1.0;
    const double front = portable::exp(portable::lgamma(a + b) - portable::lgamma(a) - portable::lgamma(b) +
                                       a * portable::log(x) + b * portable::log1p(-x));
    if (x < (a + 1.0) / (a + b + 2.0)) return front * beta_fraction(x, a, b) / a;
    return 1.0 - front * beta_fraction(1.0 - x, b, a) / b;
}

/// A floor near a bin, and from how many cells it is known.
struct Floor {
    double power = 0.0, cells = 0.0;
};

constexpr double normal_quartile = 0.6745;  // upper quartile of the normal distribution

/// A quantile of a mean of `averages` exponentials over its expectation; `normal` is that of the normal
/// distribution. The cube root is nearly normal (Wilson and Hilferty 1931).
double quantile_over_mean(double averages, double normal) {
    const double variance = 1.0 / (9.0 * averages);
    const double cube_root = 1.0 - variance + normal * std::sqrt(variance);
    return cube_root * cube_root * cube_root;
}

constexpr double uncensored_share =
    0.75;  // share of the values around a bin: lines in the others do not raise the floor

/// Expectation of floor_from() for values of mean 1, each the mean of `averages` exponentials.
double censored_expectation(double averages) {
    const double n = averages;
    const double quantile = quantile_over_mean(averages, normal_quartile);
    const double partial_mean = uncensored_share - portable::exp(n * portable::log(n * quantile) -
                                                                 n * quantile - portable::lgamma(n + 1.0));
    return (partial_mean + (1.0 - uncensored_share) * quantile) / uncensored_share;
}

/// Mean noise of values that are exponential means, from their lower three quarters: the others count as if
/// at the largest of these (type-II censoring, of which this is the maximum-likelihood estimate; with the
/// variance of the mean of so many values). Reorders the values.
Floor floor_from(std::vector<double>& values, double averages, double bins_per_cell) {
    const auto kept =
        static_cast<std::size_t>(std::ceil(uncensored_share * static_cast<double>(values.size())));
    if (kept == 0) return {};
    const auto last = values.begin() + static_cast<std::ptrdiff_t>(kept - 1);
    std::nth_element(values.begin(), last, values.end());
    double sum = static_cast<double>(values.size() - kept) * *last;
    for (auto value = values.begin(); value <= last; ++value) sum += *value;
    return {sum / static_cast<double>(kept) / censored_expectation(averages),
            static_cast<double>(kept) / bins_per_cell};
}

std::size_t bins_of(const PowerSpectrum& s, double cells) {
    return static_cast<std::size_t>(std::ceil(cells * s.bins_per_cell));
}

/// The floors around a bin, near and far. Both sides shrink alike near an end of the spectrum, where one
/// flank of a steep floor would bias the estimate, down to so few cells that the other side alone has to do.
/// Empty where too few cells lie around the bin.
std::vector<Floor> floors_about(const PowerSpectrum& s, std::size_t bin) {
    const std::size_t below = bin - s.first, above = s.power.size() - 1 - bin;
    const std::size_t guard = bins_of(s, guard_cells), fewest = bins_of(s, fewest_cells);
    const auto beyond_guard = [guard](std::size_t room) { return room > guard ? room - guard : 0; };
    std::vector<Floor> floors;
    if (beyond_guard(below) + beyond_guard(above) < fewest) return floors;
    const std::size_t shorter = std::min(below, above), longer = std::max(below, above);
    for (const auto& [from, to] : {std::pair{inner_from_cells, inner_to_cells}, {guard_cells, far_cells}}) {
        const std::size_t reach = std::min(bins_of(s, to), shorter >= guard + fewest ? shorter : longer);
        std::vector<double> values;
        for (std::size_t d = bins_of(s, from); d <= reach; ++d) {
            if (d <= below) values.push_back(s.power[bin - d]);
            if (d <= above) values.push_back(s.power[bin + d]);
        }
        if (!values.empty()) floors.push_back(floor_from(values, s.averages, s.bins_per_cell));
    }
    return floors;
}

/// Independent tries among the bins that are searched.
double tries_of(const PowerSpectrum& s) {
    const std::size_t from = std::min(std::max(s.first, s.searched), s.power.size());
    return std::max(1.0, tries_per_cell * static_cast<double>(s.power.size() - from) / s.bins_per_cell);
}

}  // namespace

double median_over_mean(double averages) {
    const double k = averages;
    return (k - 1.0 / 3.0 + 8.0 / (405.0 * k) + 184.0 / (25515.0 * k * k) +
            2248.0 / (3444525.0 * k * k * k)) /
           k;
}

double exceedance(const PowerOverFloor& seen) {
    const auto [ratio, averages, cells] = seen;
    if (!(ratio > 0.0)) return 1.0;
    const double knowledge = std::max(0.5, cells * averages);
    return incomplete_beta(knowledge / (knowledge + averages * ratio), knowledge, averages);
}

std::vector<double> noise_floor(const PowerSpectrum& spectrum) {
    const std::size_t n = spectrum.power.size();
    std::vector<double> floor(n, 0.0);
    if (n <= spectrum.first) return floor;
    const double reach_bins = far_cells * spectrum.bins_per_cell;
    const auto stride = static_cast<std::size_t>(std::max(1.0, reach_bins / 8.0));
    const auto reach = static_cast<std::size_t>(std::ceil(reach_bins));
    RunningMedian median_around(spectrum.power);
    std::vector<double> values;
    const auto quartile = [&](std::size_t from, std::size_t count) {
        values.assign(spectrum.power.begin() + static_cast<std::ptrdiff_t>(from),
                      spectrum.power.begin() + static_cast<std::ptrdiff_t>(from + count));
        const auto place = values.begin() + static_cast<std::ptrdiff_t>(count / 4);
        std::nth_element(values.begin(), place, values.end());
        return *place;
    };
    const auto at = [&](std::size_t bin) {
        const std::size_t inside =
            std::clamp(bin, std::min(spectrum.first + stride, n - 1), n - 1 - std::min(stride, n - 1));
        const std::size_t middle = std::max(inside, spectrum.first);
        // Both sides alike: one flank of a steep floor would stand for too little or too much.
        const std::size_t half = std::min({reach, middle - spectrum.first, n - 1 - middle});
        // A strong line and its side lobes are more than half of few cells: their lower quartile stands for
        // the median.
        const bool few = static_cast<double>(half) < 0.5 * reach_bins;
        const std::size_t from = middle - half, count = 2 * half + 1;
        const double averages = spectrum.averages;
        return std::max(few ? quartile(from, count) / quantile_over_mean(averages, -normal_quartile)
                            : median_around.at(from, count) / median_over_mean(averages),
                        1e-300);
    };
    // Between places a stride apart the floor runs on a straight line in log power.
    std::vector<double> levels{at(spectrum.first)}, factors;
    for (std::size_t from = spectrum.first; from < n; from += stride) {
        const std::size_t to = std::min(from + stride, n - 1);
        const double here = levels.back();
        levels.push_back(at(to));
        factors.push_back(to > from ? portable::log(levels.back() / here) / static_cast<double>(to - from)
                                    : 0.0);
    }
    portable::many_exp(factors);
    for (std::size_t i = 0; i < factors.size(); ++i) {
        const std::size_t from = spectrum.first + i * stride;
        double level = levels[i];
        for (std::size_t k = from; k < std::min(from + stride, n); ++k, level *= factors[i]) floor[k] = level;
    }
    return floor;
}

std::vector<SignificantPeak> significant_peaks(const PowerSpectrum& spectrum, std::span<const double> floor,
                                               double false_alarm) {
    std::vector<SignificantPeak> peaks;
    const auto& power = spectrum.power;
    if (power.size() < spectrum.first + 8) return peaks;
    const double tries = tries_of(spectrum);
    const auto chance_over = [&](std::size_t k, const Floor& level) {
        return tries *
               exceedance(
                   {.ratio = power[k] / level.power, .averages = spectrum.averages, .cells = level.cells});
    };
    for (std::size_t k = std::max(spectrum.first + 1, spectrum.searched); k + 1 < power.size(); ++k) {
        if (power[k] < power[k - 1] || power[k] <= power[k + 1]) continue;
        // A cheap sieve with a wide margin: the floors below are seldom less than a quarter of the running
        // one.
        if (chance_over(k, {0.25 * floor[k], 1e6}) > 1.0) continue;
        SignificantPeak peak{k, 0.0, 0.0};
        const std::vector<Floor> floors = floors_about(spectrum, k);
        for (const Floor& level : floors) {
            peak.floor = std::max(peak.floor, level.power);
            peak.false_alarm = std::max(peak.false_alarm, std::min(1.0, chance_over(k, level)));
        }
        if (!floors.empty() && peak.false_alarm <= false_alarm) peaks.push_back(peak);
    }
    return peaks;
}

double exceeded(double chance, PowerOverFloor noise) {
    const auto is_below = [&](double ratio) {
        noise.ratio = ratio;
        return exceedance(noise) > chance;
    };
    double high = 1.0;
    while (is_below(high) && high < 1e100) high *= 2.0;
    double low = 0.5 * high;
    for (int halving = 0; halving < 50; ++halving) {
        const double middle = 0.5 * (low + high);
        (is_below(middle) ? low : high) = middle;
    }
    return high;
}

double chi_square_chance(double squares, double freedom) {
    const double spread = 2.0 / (9.0 * freedom);
    const double normal = (portable::cbrt(squares / freedom) - (1.0 - spread)) / std::sqrt(spread);
    return 0.5 * std::erfc(normal / std::sqrt(2.0));
}

double excess_scatter(double squares, double freedom) {
    constexpr double rare = 0.01;
    const bool scatters = freedom >= 1.0 && chi_square_chance(squares, freedom) < rare;
    return scatters ? std::sqrt(squares / freedom) : 1.0;
}

double least_amplitude_nm(std::span<const TraceView> logs, double share) {
    double range = 0.0, largest = 0.0;
    for (const TraceView& log : logs) {
        const auto [low, high] = std::minmax_element(log.torque_nm.begin(), log.torque_nm.end());
        if (low == log.torque_nm.end()) continue;
        range = std::max(range, *high - *low);
        largest = std::max({largest, std::abs(*low), std::abs(*high)});
    }
    return std::max(share * range, 1e-9 * largest);
}

}  // namespace ripplenotch
