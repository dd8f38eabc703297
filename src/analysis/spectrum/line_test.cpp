// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/line_test.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/shared_limits.hpp"
#include "analysis/spectrum/running_median.hpp"
#include "core/functions/many_numbers.hpp"
#include "ripplenotch/core/median.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr double lobe_cells = 4.0 / 3.0;  // half of a Hann line's main lobe: two cycles
constexpr double guard_cells = 3.0;       // the main lobe of a Hann line and its first side lobe
constexpr double near_cells = 12.0;       // by hand: from a line, for a floor that slopes
constexpr double far_cells = 40.0;        // by hand: for a median that is known better
constexpr double inner_from_cells = 2.0;  // noise through a lightly damped resonance is only a few cells wide
constexpr double inner_to_cells = 5.0;    // by hand
constexpr double fewest_cells = 4.0;      // by hand

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

std::size_t bins_of(const PowerSpectrum& s, double cells) {
    return static_cast<std::size_t>(std::ceil(cells * s.bins_per_cell));
}

/// How far from a bin its floor is measured, `outer` bins at most. Both sides shrink alike near an end of the
/// spectrum, since one flank of a steep floor would stand for too little or too much; but one side has to hold
/// the fewest cells that a floor can be known from.
std::size_t outer_of(const PowerSpectrum& s, std::size_t bin, std::size_t outer) {
    const std::size_t room = std::min(bin - s.first, s.power.size() - 1 - bin);
    return std::min(outer, std::max(room, bins_of(s, guard_cells + fewest_cells)));
}

/// Bins from `inner` to `outer` away from `bin`, on each side as far as there are bins.
void gather(const PowerSpectrum& s, std::size_t bin, std::size_t inner, std::size_t outer,
            std::vector<double>& into) {
    outer = outer_of(s, bin, outer);
    const std::size_t below = bin - s.first, above = s.power.size() - 1 - bin;
    for (std::size_t d = inner; d <= std::min(outer, below); ++d) into.push_back(s.power[bin - d]);
    for (std::size_t d = inner; d <= std::min(outer, above); ++d) into.push_back(s.power[bin + d]);
}

/// Cells between `guard_cells` and `reach_cells` on both sides, as far as there are bins.
double cells_around(const PowerSpectrum& s, std::size_t bin, double reach_cells) {
    const std::size_t inner = bins_of(s, guard_cells), outer = outer_of(s, bin, bins_of(s, reach_cells));
    double bins = 0.0;
    for (const std::size_t room : {bin - s.first, s.power.size() - 1 - bin}) {
        const std::size_t end = std::min(outer, room);
        if (end >= inner) bins += static_cast<double>(end - inner + 1);
    }
    return bins / s.bins_per_cell;
}

/// The four floors about a bin, the cheapest first, until their largest is above `most`.
double floor_at(const PowerSpectrum& s, std::size_t bin, double most, std::vector<double>& scratch) {
    const double to_mean = median_over_mean(s.averages_at(bin));
    double local = 0.0;
    const auto raised = [&] {
        if (!scratch.empty()) local = std::max(local, median_in(scratch) / to_mean);
        scratch.clear();
        return local > most;
    };
    gather(s, bin, bins_of(s, inner_from_cells), bins_of(s, inner_to_cells), scratch);
    if (raised()) return local;
    // The lower side alone, since spectra of motion fall steeply from their low end. Near that end what is
    // just outside of the main lobe has to do: a line stands above it, a slope does not.
    const std::size_t below = bin - s.first;
    std::size_t inner = bins_of(s, guard_cells);
    if (below < inner + bins_of(s, 1.0)) inner = bins_of(s, lobe_cells);
    for (std::size_t d = inner; d <= std::min(bins_of(s, near_cells), below); ++d)
        scratch.push_back(s.power[bin - d]);
    if (raised()) return local;
    for (const double reach_cells : {near_cells, far_cells}) {
        gather(s, bin, bins_of(s, guard_cells), bins_of(s, reach_cells), scratch);
        if (raised()) return local;
    }
    return local;
}

/// A ratio below which noise exceeds it more often than `chance`, and not far below the highest such: most
/// bins are below it, and are not worth more than a comparison. Neighbouring bins share it; one that nobody
/// shares is not worth finding, and is 0.
class LeastRatio {
  public:
    explicit LeastRatio(double chance) : chance_(chance) {}

    double at(double averages, double cells) {
        const bool again = averages == averages_ && cells == cells_;
        if (again && ratio_ > 0.0) return ratio_;
        averages_ = averages;
        cells_ = cells;
        return ratio_ = again ? found() : 0.0;
    }

  private:
    [[nodiscard]] double found() const {
        const auto is_below = [this](double ratio) {
            return exceedance({.ratio = ratio * (1.0 + 1e-9), .averages = averages_, .cells = cells_}) >
                   chance_;
        };
        double high = 1.0;
        while (is_below(high) && high < 1e100) high *= 2.0;
        double low = 0.5 * high;
        if (!is_below(low)) return 1e-300;
        for (int halving = 0; halving < 8; ++halving) {
            const double middle = 0.5 * (low + high);
            (is_below(middle) ? low : high) = middle;
        }
        return low;
    }

    double chance_, averages_ = -1.0, cells_ = -1.0, ratio_ = 0.0;
};

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
    // A median of m exponentials knows their mean as well as 0.48 m of them averaged: (ln 2)^2.
    const double knowledge = std::max(0.5, 0.48 * cells * averages);
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
    const auto at = [&](std::size_t bin) {
        const std::size_t inside =
            std::clamp(bin, std::min(spectrum.first + stride, n - 1), n - 1 - std::min(stride, n - 1));
        const std::size_t middle = std::max(inside, spectrum.first);
        // Both sides alike: one flank of a steep floor would stand for too little or too much.
        const std::size_t half = std::min({reach, middle - spectrum.first, n - 1 - middle});
        return std::max(
            median_around.at(middle - half, 2 * half + 1) / median_over_mean(spectrum.averages_at(bin)),
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

std::vector<SignificantPeak> significant_peaks(const PowerSpectrum& spectrum, double false_alarm) {
    return significant_peaks(spectrum, noise_floor(spectrum), false_alarm);
}

std::vector<SignificantPeak> significant_peaks(const PowerSpectrum& spectrum, std::span<const double> floor,
                                               double false_alarm) {
    std::vector<SignificantPeak> peaks;
    const auto& power = spectrum.power;
    if (power.size() < spectrum.first + 8) return peaks;
    const double tries = tries_of(spectrum);
    std::vector<double> scratch;
    LeastRatio worth_a_look(1.0 / tries), significant(false_alarm / tries);
    for (std::size_t k = std::max(spectrum.first + 1, spectrum.searched); k + 1 < power.size(); ++k) {
        if (power[k] < power[k - 1] || power[k] <= power[k + 1]) continue;
        // A cheap sieve with a wide margin: the floors below are seldom less than a quarter of the running
        // one.
        const double averages = spectrum.averages_at(k), rough = 4.0 * power[k] / floor[k];
        if (rough < worth_a_look.at(averages, 1e6) ||
            tries * exceedance({.ratio = rough, .averages = averages, .cells = 1e6}) > 1.0)
            continue;
        if (cells_around(spectrum, k, near_cells) < fewest_cells) continue;
        const double cells = cells_around(spectrum, k, far_cells);
        const double most = power[k] / significant.at(averages, cells);  // infinite at 0
        const double local = floor_at(spectrum, k, most, scratch);
        if (!(local > 0.0) || local > most) continue;
        const double chance = std::min(
            1.0, tries * exceedance({.ratio = power[k] / local, .averages = averages, .cells = cells}));
        if (chance <= false_alarm) peaks.push_back({k, local, chance});
    }
    return peaks;
}

double ratio_exceeded(double chance, double averages, double cells) {
    const auto is_below = [&](double ratio) {
        return exceedance({.ratio = ratio, .averages = averages, .cells = cells}) > chance;
    };
    double high = 1.0;
    while (is_below(high) && high < 1e100) high *= 2.0;
    double low = 0.5 * high;
    for (int halving = 0; halving < 20; ++halving) {
        const double middle = 0.5 * (low + high);
        (is_below(middle) ? low : high) = middle;
    }
    return high;
}

double significant_power(const PowerSpectrum& spectrum, std::size_t bin, double false_alarm) {
    constexpr double none = std::numeric_limits<double>::infinity();
    if (bin <= spectrum.first || bin < spectrum.searched || bin + 1 >= spectrum.power.size()) return none;
    if (cells_around(spectrum, bin, near_cells) < fewest_cells) return none;
    std::vector<double> scratch;
    return floor_at(spectrum, bin, none, scratch) *
           ratio_exceeded(false_alarm / tries_of(spectrum), spectrum.averages_at(bin),
                          cells_around(spectrum, bin, far_cells));
}

double detectable_ratio(double threshold, double averages) {
    // 1 + r - z sqrt((1 + 2 r) / averages) = threshold, of which the larger root: with u = sqrt(1 + 2 r),
    // u^2 - 2 z u / sqrt(averages) + 1 = 2 threshold.
    constexpr double one_sided_95 = 1.645;
    const double half = one_sided_95 / std::sqrt(averages);
    const double u = half + std::sqrt(half * half + std::max(0.0, 2.0 * threshold - 1.0));
    return std::max(0.0, 0.5 * (u * u - 1.0));
}

}  // namespace ripplenotch
