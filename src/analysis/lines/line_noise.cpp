// SPDX-License-Identifier: MIT
// The noise at each place of a sweep's spectrum, and the law of a power over it.
#include "analysis/lines/line_scan.hpp"

#include <algorithm>
#include <cmath>

#include "core/functions/many_numbers.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr double wide_cells = 20.0, near_cells = 5.0;
constexpr double humps_share = 0.05;  // of the places: chosen, not derived
constexpr double highest_hump = 4.6;  // ln 100
constexpr double own_cells = 1.5;     // to either side of a line, its own width, are no noise

/// -ln of the survival of F(2, 2 m) at power over noise x: Exp(1) without a line although the noise is an
/// estimate.
double score_of(double x, double m) { return m * portable::log1p(x / m); }
/// Straight lines through ln power over ln place, from the cells on either side of a place.
class LocalLines {
  public:
    LocalLines(std::span<const double> x, std::span<const double> y) : x_(x) {
        const std::size_t n = x.size();
        for (auto* sums : {&x_sum_, &xx_sum_, &y_sum_, &xy_sum_}) sums->assign(n + 1, 0.0);
        for (std::size_t i = 0; i < n; ++i) {
            x_sum_[i + 1] = x_sum_[i] + x[i];
            xx_sum_[i + 1] = xx_sum_[i] + x[i] * x[i];
            y_sum_[i + 1] = y_sum_[i] + y[i];
            xy_sum_[i + 1] = xy_sum_[i] + x[i] * y[i];
        }
    }
    /// Value at entry i and its variance, from the entries that are more than `own` and at most `half` away,
    /// each of this variance.
    [[nodiscard]] std::pair<double, double> at(std::ptrdiff_t i, std::ptrdiff_t own, std::ptrdiff_t half,
                                               double entry_variance) const {
        const std::ptrdiff_t n = std::ssize(x_);
        const auto place = [n](std::ptrdiff_t k) {
            return static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k, 0, n));
        };
        const std::size_t a = place(i - half), b = place(i - own), c = place(i + own + 1),
                          d = place(i + half + 1);
        const auto sum = [&](const std::vector<double>& s) { return s[b] - s[a] + s[d] - s[c]; };
        const auto count = static_cast<double>(b - a + d - c);
        if (count < 3.0) return {0.0, 1e9};
        const double mean = sum(x_sum_) / count, y_mean = sum(y_sum_) / count;
        const double xx = sum(xx_sum_) - count * mean * mean, xy = sum(xy_sum_) - count * mean * y_mean;
        const double away = x_[static_cast<std::size_t>(i)] - mean;
        return {y_mean + away * xy / xx, entry_variance * (1.0 / count + away * away / xx)};
    }

  private:
    std::span<const double> x_;
    std::vector<double> x_sum_, xx_sum_, y_sum_, xy_sum_;
};

}  // namespace

// The logarithm of the power of noise has the variance pi^2 / 6 whatever its spectrum, and lines, of which
// there may be many, count little in a mean of logarithms that are cut at three times the noise.
LineScan::Noise LineScan::noise_of(std::span<const double> power, double length, double bottom) const {
    constexpr double euler = 0.57722, cut = 3.0, bias_of_cut = 0.01305;  // of ln of Exp(1); E1(3)
    constexpr double ln_variance = 1.64493;
    const double cell = 1.0 / length / step_;
    const std::size_t apart = std::max<std::size_t>(1, static_cast<std::size_t>(cell / 3.0));
    std::vector<double> x, y;
    std::vector<std::size_t> from;
    for (std::size_t k = 0; k < power.size(); k += apart) {
        if (place(k) < bottom || !(power[k] > 0.0)) continue;
        x.push_back(ln_place_[k]);
        y.push_back(power[k]);
        from.push_back(k);
    }
    portable::log(y, y);
    const std::vector<double> zeros(power.size());
    Noise noise{std::vector<double>(power.size(), 1e300), zeros, zeros, zeros};
    if (x.empty()) return noise;
    const auto n = std::ssize(x);
    const double entries = cell / static_cast<double>(apart);  // per cell
    const auto own = std::lround(own_cells * entries);
    std::array<std::vector<std::pair<double, double>>, 2> fits;
    for (std::size_t s = 0; s < 2; ++s) {
        const auto half = own + std::lround((s == 0 ? wide_cells : near_cells) * entries);
        auto& fit = fits.at(s);
        fit.resize(x.size());
        const double variance = ln_variance * std::max(1.0, entries * hann_cell);
        const LocalLines all(x, y);
        std::vector<double> cut_y(y);
        for (std::ptrdiff_t i = 0; i < n; ++i) {
            const auto k = static_cast<std::size_t>(i);
            cut_y[k] = std::min(y[k], all.at(i, -1, half, variance).first + euler + portable::log(cut));
        }
        const LocalLines lines(x, cut_y);
        for (std::ptrdiff_t i = 0; i < n; ++i) {
            fit[static_cast<std::size_t>(i)] = lines.at(i, own, half, variance);
            fit[static_cast<std::size_t>(i)].first += euler + bias_of_cut;
        }
    }
    for (std::size_t k = from.front(); k < power.size(); ++k) {
        const std::size_t i = std::min((k - from.front()) / apart, x.size() - 1),
                          next = std::min(i + 1, x.size() - 1);
        const double part = next == i ? 0.0 : static_cast<double>(k - from[i]) / static_cast<double>(apart);
        const auto value = [&](std::size_t s) {
            return fits.at(s)[i].first + part * (fits.at(s)[next].first - fits.at(s)[i].first);
        };
        noise.power[k] = value(0);
        noise.variance[k] = fits[0][i].second;
        noise.rise[k] = value(1) - value(0);
        noise.rise_variance[k] = fits[1][i].second + fits[0][i].second;
    }
    portable::many_exp(std::span(noise.power).subspan(from.front()));
    return noise;
}

// Without a hump the rise is 0 but for its error; with one, anything up to highest_hump.
LineScan::Humps LineScan::humps_of(const Listed& list) const {
    const std::vector<double> zeros(count_);
    Humps humps{zeros, zeros, zeros};
    for (std::size_t k = 0; k < count_; ++k) {
        double weights = 0.0, sum = 0.0;
        for (std::size_t i = 0; i < list.pieces.size(); ++i) {
            const Noise& noise = *list.noises[i];
            if (!list.pieces[i]->shows(place(k)) || !(noise.rise_variance[k] > 0.0)) continue;
            weights += 1.0 / noise.rise_variance[k];
            sum += noise.rise[k] / noise.rise_variance[k];
        }
        if (!(sum > 0.0)) continue;
        humps.rise[k] = sum / weights;
        humps.variance[k] = 1.0 / weights;
        const double odds = humps_share / (1.0 - humps_share) / highest_hump *
                            std::sqrt(full_turn * humps.variance[k]) *
                            portable::exp(std::min(600.0, 0.5 * humps.rise[k] * sum));
        humps.chance[k] = odds / (1.0 + odds);
    }
    return humps;
}

// By likelihood under the law of F. Of powers above `large`, which may be those of lines, only the number
// counts, so that the bulk of the noise tells.
std::vector<double> LineScan::excess_of(const Listed& list, const Humps& humps) const {
    constexpr double large = 1.5;
    std::vector<Evidences> octaves(octave(count_ - 1) + 1);
    for (std::size_t i = 0; i < list.pieces.size(); ++i) {
        const Noise& noise = *list.noises[i];
        const auto stride = static_cast<std::size_t>(hann_cell / list.pieces[i]->length / step_);
        for (std::size_t k = 0; k < count_; k += std::max<std::size_t>(1, stride)) {
            if (!list.pieces[i]->shows(place(k)) || !(noise.variance[k] > 0.0)) continue;
            const double x =
                list.powers[i][k] / noise.power[k] * portable::exp(-humps.chance[k] * humps.rise[k]);
            for (std::size_t e = 0; e < excesses.size(); ++e) {
                const double m = 1.0 / (noise.variance[k] + excesses.at(e));
                octaves[octave(k)].at(e) -=
                    (m + (x < large ? 1.0 : 0.0)) * portable::log1p(std::min(x, large) / m);
            }
        }
    }
    std::vector<double> excess;
    for (std::size_t b = 0; b < octaves.size(); ++b) {
        Evidences sum = octaves[b];  // with half of what its neighbours say
        for (std::size_t e = 0; e < sum.size(); ++e) {
            if (b > 0) sum.at(e) += 0.5 * octaves[b - 1].at(e);
            if (b + 1 < octaves.size()) sum.at(e) += 0.5 * octaves[b + 1].at(e);
        }
        const double most = *std::max_element(sum.begin(), sum.end());
        double mean = 0.0, all = 0.0, prior = 1.0;
        for (std::size_t e = 0; e < sum.size();
             ++e, prior *= 0.5) {  // each half as probable as the one before
            const double p = prior * portable::exp(sum.at(e) - most);
            mean += p * excesses.at(e);
            all += p;
        }
        excess.push_back(mean / all);
    }
    return excess;
}

double LineScan::score_at(double power, const Noise& noise, const Humps& humps, std::size_t k,
                          double excess) {
    const double without = score_of(power / noise.power[k], 1.0 / (noise.variance[k] + excess));
    if (humps.chance[k] < 1e-6) return without;
    const double with = score_of(power / noise.power[k] * portable::exp(-humps.rise[k]),
                                 1.0 / (noise.variance[k] + humps.variance[k] + excess));
    const double least = std::min(without, with);
    return least - portable::log((1.0 - humps.chance[k]) * portable::exp(least - without) +
                                 humps.chance[k] * portable::exp(least - with));
}

// score_at() of all places, by many logarithms at once.
std::vector<double> LineScan::scores(std::span<const double> power, const Noise& noise,
                                     const Humps& humps) const {
    std::vector<double> without(count_), with(count_), part(count_);
    for (std::size_t k = 0; k < count_; ++k) part[k] = -humps.rise[k];
    portable::many_exp(part);
    for (std::size_t k = 0; k < count_; ++k) {
        const double x = power[k] / noise.power[k];
        without[k] = 1.0 + x * noise.variance[k];
        with[k] = 1.0 + x * part[k] * (noise.variance[k] + humps.variance[k]);
    }
    portable::log(without, without);
    portable::log(with, with);
    for (std::size_t k = 0; k < count_; ++k) {
        without[k] /= std::max(noise.variance[k], 1e-300);
        with[k] /= std::max(noise.variance[k] + humps.variance[k], 1e-300);
        part[k] = -std::min(std::abs(with[k] - without[k]), 600.0);
    }
    portable::many_exp(part);
    for (std::size_t k = 0; k < count_; ++k) {
        const double chance = humps.chance[k];
        part[k] = with[k] > without[k] ? 1.0 - chance + chance * part[k] : (1.0 - chance) * part[k] + chance;
    }
    portable::log(part, part);
    for (std::size_t k = 0; k < count_; ++k) part[k] = std::min(with[k], without[k]) - part[k];
    return part;
}

}  // namespace ripplenotch
