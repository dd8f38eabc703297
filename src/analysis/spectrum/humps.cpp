// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/humps.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "ripplenotch/core/median.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr double narrowest_cells = 2.5;  // narrower ones are lines, or noise
constexpr double least_ratio = 4.0;      // of power: twice the noise's amplitude, what a person sees
// A hump reaches as far as its power is this much above the noise, and this share of its highest: 15 dB down.
constexpr double edge_ratio = 2.0, edge_share = 0.03;
// In blocks, of which a window has four.
constexpr std::size_t window_blocks = 4, guard_blocks = 2, side_blocks = 24, fewest_side_blocks = 6,
                      around_blocks = 64;
// Windows overlap, and those of neighbouring widths are alike: about this many independent tries per block.
constexpr double tries_per_window = 0.5;
constexpr double narrow_cells = 20.0, sieve_ratio = 2.0;  // by hand: only what is looked at more closely
constexpr std::size_t most_lags = 64;                     // by hand: bounds the time
constexpr double clipped_ratio = 4.0;                     // so that humps themselves do not make cells alike

/// How far the cells are as independent, and as well averaged, as they are said to be: cells so many apart
/// may be alike, and one loud piece of many makes their mean no better than itself.
class Alikeness {
  public:
    explicit Alikeness(const PowerSpectrum& spectrum) {
        const auto stride = static_cast<std::size_t>(std::ceil(4.0 / 3.0 * spectrum.bins_per_cell));
        floor_ = noise_floor(spectrum);
        const std::vector<double>& floor = floor_;
        std::vector<double> cells;
        double averages = 0.0;
        for (std::size_t k = spectrum.first; k < spectrum.power.size(); k += stride) {
            cells.push_back(std::min(spectrum.power[k] / floor[k], clipped_ratio));
            averages += spectrum.averages_at(k);
        }
        stride_cells_ = static_cast<double>(stride) / spectrum.bins_per_cell;
        const std::size_t count = cells.size();
        double mean = 0.0, variance = 0.0;
        for (const double cell : cells) mean += cell / static_cast<double>(count);
        for (double& cell : cells) {
            cell -= mean;
            variance += cell * cell;
        }
        averages /= static_cast<double>(count);
        // A mean of so many exponentials has the square of its mean over its variance.
        const double seen = mean * mean * static_cast<double>(count) / variance;
        averages_share_ = seen < averages ? seen / averages : 1.0;
        const double noise = 3.0 / std::sqrt(static_cast<double>(count));
        for (std::size_t lag = 1; lag <= std::min(most_lags, count / 8) && variance > 0.0; ++lag) {
            double product = 0.0;
            for (std::size_t i = lag; i < count; ++i) product += cells[i] * cells[i - lag];
            const double alike = product / variance;
            correlation_.push_back(alike > noise ? alike : 0.0);
        }
    }
    /// The running noise floor, which only humps half as wide as its window raise.
    [[nodiscard]] const std::vector<double>& floor() const { return floor_; }
    /// Of the averages that the spectrum says it has.
    [[nodiscard]] double averages_share() const { return averages_share_; }
    /// That count as one in a mean over `width` cells.
    [[nodiscard]] double cells_for_one(double width) const {
        double sum = 1.0;
        for (std::size_t i = 0; i < correlation_.size(); ++i) {
            const double apart = static_cast<double>(i + 1) * stride_cells_;
            if (apart < width) sum += 2.0 * stride_cells_ * (1.0 - apart / width) * correlation_[i];
        }
        return sum;
    }

  private:
    std::vector<double> correlation_, floor_;
    double stride_cells_ = 1.0, averages_share_ = 1.0;
};

/// Mean power of consecutive blocks of so many bins, from the spectrum's first on.
struct Blocks {
    std::vector<double> mean;
    std::size_t bins = 1, first = 0;
    double cells = 1.0;  // per block

    Blocks(const PowerSpectrum& spectrum, std::size_t bins_per_block)
        : bins(bins_per_block),
          first(spectrum.first),
          cells(static_cast<double>(bins_per_block) / spectrum.bins_per_cell) {
        for (std::size_t k = first; k + bins <= spectrum.power.size(); k += bins) {
            double sum = 0.0;
            for (std::size_t i = 0; i < bins; ++i) sum += spectrum.power[k + i];
            mean.push_back(sum / static_cast<double>(bins));
        }
    }
};

struct HumpCandidate {
    SignificantHump hump;
    double gain = 0.0;  // nats
};

/// The spectrum seen at one width.
class Level {
  public:
    Level(const PowerSpectrum& spectrum, std::size_t bins_per_block, const Alikeness& alike)
        : spectrum_(spectrum), blocks_(spectrum, bins_per_block) {
        window_cells_ = window_blocks * blocks_.cells;
        counted_ = 1.0 / alike.cells_for_one(window_cells_);
        averages_share_ = alike.averages_share();
        if (window_cells_ < narrow_cells) running_floor_ = alike.floor();
    }
    [[nodiscard]] bool fits() const {
        return blocks_.mean.size() >= window_blocks + 2 * (guard_blocks + fewest_side_blocks);
    }
    [[nodiscard]] double tries() const { return tries_per_window * static_cast<double>(blocks_.mean.size()); }
    void search(double tries, double false_alarm, std::vector<HumpCandidate>& into) {
        const std::size_t margin = guard_blocks + fewest_side_blocks;
        for (std::size_t at = margin; at + window_blocks + margin <= blocks_.mean.size(); ++at) {
            double power = 0.0;
            for (std::size_t i = 0; i < window_blocks; ++i) power += blocks_.mean[at + i] / window_blocks;
            // A cheap sieve with a wide margin: medians beside every window would cost more than the
            // spectrum.
            const std::size_t bin = blocks_.first + at * blocks_.bins;
            if (!running_floor_.empty() && power < sieve_ratio * running_floor_[bin]) continue;
            judge(at, power, tries, false_alarm, into);
        }
    }

  private:
    /// Behind a mean over so many cells, here.
    [[nodiscard]] double averages_of(double cells, std::size_t at) const {
        const double said = spectrum_.averages_at(blocks_.first + at * blocks_.bins);
        return std::max(1.0, cells * counted_) * std::max(1.0, averages_share_ * said);
    }
    /// Blocks [from, to) that are not next to the window at `at`: those before it and those behind it.
    struct Beside {
        std::size_t from = 0, to = 0, at = 0;
        using Range = std::pair<std::size_t, std::size_t>;
        [[nodiscard]] std::array<Range, 2> ranges() const {
            const std::size_t before = std::min(to, at - std::min(at, guard_blocks)),
                              behind = std::max(from, at + window_blocks + guard_blocks);
            return {Range{from, std::max(from, before)}, Range{std::min(behind, to), to}};
        }
    };
    /// Their median.
    double median_of(const Beside& beside) {
        scratch_.clear();
        for (const auto& [from, to] : beside.ranges())
            scratch_.insert(scratch_.end(), blocks_.mean.begin() + static_cast<std::ptrdiff_t>(from),
                            blocks_.mean.begin() + static_cast<std::ptrdiff_t>(to));
        return median_in(scratch_);
    }
    /// That their median is above `most`, by a count: what most windows come to costs no median.
    [[nodiscard]] bool median_above(double most, const Beside& beside) const {
        std::size_t count = 0, above = 0;
        for (const auto& [from, to] : beside.ranges()) {
            count += to - from;
            for (std::size_t i = from; i < to; ++i) above += static_cast<std::size_t>(blocks_.mean[i] > most);
        }
        return above > 0 && above >= count - count / 2;
    }
    void judge(std::size_t at, double power, double tries, double false_alarm,
               std::vector<HumpCandidate>& into) {
        const std::size_t end = at + window_blocks, count = blocks_.mean.size();
        const auto before = [at](std::size_t blocks) { return at - std::min(at, blocks + guard_blocks); };
        const auto after = [=](std::size_t blocks) { return std::min(count, end + blocks + guard_blocks); };
        const Beside left{before(side_blocks), at, at}, right{end, after(side_blocks), at};
        const double to_mean = median_over_mean(averages_of(blocks_.cells, at));
        const double most = power / least_ratio * to_mean * (1.0 + 1e-9);  // beyond what rounding makes equal
        if (median_above(most, left) || median_above(most, right)) return;
        const double below = median_of(left) / to_mean, above = median_of(right) / to_mean;
        if (power < least_ratio * below || power < least_ratio * above) return;
        const double around = median_of({before(around_blocks), after(around_blocks), at}) / to_mean;
        const double floor = std::max({below, above, around});
        const double ratio = power / floor;
        if (!(floor > 0.0) || ratio < least_ratio) return;
        const double averages = averages_of(window_cells_, at);
        const double side =
            static_cast<double>(std::min(at - before(side_blocks), after(side_blocks) - end) - guard_blocks);
        const double chance =
            std::min(1.0, tries * exceedance({.ratio = ratio,
                                              .averages = averages,
                                              .cells = median_efficiency * side / window_blocks}));
        if (chance > false_alarm) return;
        into.push_back({grown(at, floor, chance), averages * (ratio - 1.0 - portable::log(ratio))});
    }
    /// The window's highest block and its neighbours to both sides, as far as they stand out.
    SignificantHump grown(std::size_t at, double floor, double chance) const {
        const auto& mean = blocks_.mean;
        const auto highest = std::max_element(mean.begin() + static_cast<std::ptrdiff_t>(at),
                                              mean.begin() + static_cast<std::ptrdiff_t>(at + window_blocks));
        auto from = static_cast<std::size_t>(highest - mean.begin()), to = from + 1;
        const double edge = std::max(edge_ratio * floor, edge_share * *highest);
        while (from > 0 && mean[from - 1] > edge) --from;
        while (to < mean.size() && mean[to] > edge) ++to;
        return {blocks_.first + from * blocks_.bins, blocks_.first + to * blocks_.bins, floor, chance};
    }

    PowerSpectrum spectrum_;
    Blocks blocks_;
    double window_cells_ = 0.0, counted_ = 1.0, averages_share_ = 1.0;
    std::span<const double> running_floor_;  // of narrow windows
    std::vector<double> scratch_;
};

}  // namespace

std::vector<SignificantHump> significant_humps(const PowerSpectrum& spectrum, double false_alarm) {
    std::vector<SignificantHump> humps;
    if (spectrum.power.size() <= spectrum.first) return humps;
    auto block = static_cast<std::size_t>(
        std::max(1.0, std::ceil(narrowest_cells * spectrum.bins_per_cell / window_blocks)));
    const Alikeness alike(spectrum);
    std::vector<Level> levels;
    double tries = 0.0;
    for (;; block *= 2) {
        Level level(spectrum, block, alike);
        if (!level.fits()) break;
        tries += level.tries();
        levels.push_back(std::move(level));
    }
    std::vector<HumpCandidate> candidates;
    for (Level& level : levels) level.search(tries, false_alarm, candidates);
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const HumpCandidate& a, const HumpCandidate& b) { return a.gain > b.gain; });
    for (const HumpCandidate& candidate : candidates) {
        const SignificantHump& one = candidate.hump;
        const bool known = std::any_of(humps.begin(), humps.end(), [&](const SignificantHump& hump) {
            return one.first < hump.end && hump.first < one.end;
        });
        if (!known) humps.push_back(one);
    }
    std::sort(humps.begin(), humps.end(),
              [](const SignificantHump& a, const SignificantHump& b) { return a.first < b.first; });
    return humps;
}

}  // namespace ripplenotch
