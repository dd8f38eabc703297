// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <functional>
#include <map>
#include <numbers>
#include <numeric>
#include <queue>
#include <span>
#include <utility>

#include "ripplenotch/analysis/steady.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

namespace {

constexpr double narrowest_cells = 2.5;  // narrower ones are lines, or noise
constexpr double least_ratio = 4.0;      // power ratio: twice the noise's amplitude, what a person sees
// A hump reaches as far as its power is this much above the noise, and this share of its highest: 15 dB down.
constexpr double edge_ratio = 2.0, edge_share = 0.03;
// In blocks, of which a window has four.
constexpr std::size_t window_blocks = 4, guard_blocks = 2, side_blocks = 24, fewest_side_blocks = 6,
                      around_blocks = 64;
// Windows overlap, and those of neighbouring widths are alike: about this many independent tries per block.
constexpr double tries_per_window = 0.5;
// Chosen, not derived: only preselects candidates for the test.
constexpr double narrow_cells = 20.0, sieve_ratio = 2.0;
constexpr std::size_t most_lags = 64;  // chosen, not derived: bounds the time
constexpr double clipped_ratio = 4.0;  // so that humps themselves do not make cells alike

/// How far the cells are as independent, and as well averaged, as the spectrum states: cells at some distance
/// may be correlated, and one loud piece of many makes their mean no better than itself.
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
    /// The effective number of averages, as a share of the number that the spectrum states.
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
    double gain = 0.0;  // improvement in log-likelihood, natural units
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
            // An inexpensive preselection with a wide margin: medians around every window would cost more
            // than the spectrum.
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
    /// The window's highest block and its neighbours to both sides, as far as they rise above the noise
    /// floor.
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
    std::span<const double> running_floor_;  // noise floor of narrow windows
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

namespace {

constexpr double least_turned_deg = 10.0;  // less than this is a joint that holds its place
// Student's t of five degrees of freedom over the normal distribution's, at 95 %.
constexpr double few_blocks = 2.571 / 1.960;
constexpr double least_over_noise = 5.0;  // a mean speed within so many deviations of the noise is none

/// Largest and smallest value of a window that only moves forward.
class Extremes {
  public:
    explicit Extremes(std::span<const double> values) : values_(values) {}
    void add(std::size_t k) {
        const double value = values_[k];
        while (!high_.empty() && values_[high_.back()] <= value) high_.pop_back();
        while (!low_.empty() && values_[low_.back()] >= value) low_.pop_back();
        high_.push_back(k);
        low_.push_back(k);
    }
    void drop_before(std::size_t k) {
        while (!high_.empty() && high_.front() < k) high_.pop_front();
        while (!low_.empty() && low_.front() < k) low_.pop_front();
    }
    [[nodiscard]] double highest() const { return values_[high_.front()]; }
    [[nodiscard]] double lowest() const { return values_[low_.front()]; }

  private:
    std::span<const double> values_;
    std::deque<std::size_t> high_, low_;  ///< samples that may become the extreme, in their order
};

struct Band {
    double share = 0.0, width_deg_s = 0.0;  // share of the middle speed, or absolute
    double standstill_deg_s = 0.0;
    [[nodiscard]] bool holds(double lowest, double highest) const {
        if (std::max(std::abs(lowest), std::abs(highest)) <= standstill_deg_s) return true;
        const double middle = 0.5 * (highest + lowest);
        return 0.5 * (highest - lowest) <= std::max(width_deg_s, share * std::abs(middle));
    }
};

struct Window {
    std::size_t first = 0, end = 0;
    [[nodiscard]] std::size_t count() const { return end - first; }
    /// Longest first, then earliest.
    bool operator<(const Window& other) const {
        return count() != other.count() ? count() < other.count() : first > other.first;
    }
};

bool long_enough(const Window& window, const TraceView& trace, const SteadyRule& rule) {
    if (window.end <= window.first) return false;
    const double span =
        trace.time_s[window.end - 1] - trace.time_s[window.first] + 1.0 / trace.sample_rate.value();
    return span >= rule.at_least.value() * (1.0 - 1e-9);
}

/// Every window within the band that can be extended to neither side.
std::vector<Window> maximal_windows(const TraceView& trace, std::span<const double> speed, const Band& band,
                                    const SteadyRule& rule) {
    std::vector<Window> windows;
    Extremes extremes(speed);
    std::size_t first = 0;
    const auto close = [&](std::size_t end) {
        if (const Window window{first, end}; long_enough(window, trace, rule)) windows.push_back(window);
    };
    extremes.add(0);
    auto next_run = std::upper_bound(trace.run_starts.begin(), trace.run_starts.end(), trace.first_row);
    for (std::size_t k = 1; k < speed.size(); ++k) {
        const bool jumped = next_run != trace.run_starts.end() && *next_run == trace.first_row + k;
        if (jumped) ++next_run;
        const double lowest = std::min(extremes.lowest(), speed[k]);
        const double highest = std::max(extremes.highest(), speed[k]);
        if (jumped || !band.holds(lowest, highest)) close(k);
        if (jumped) {
            first = k;
            extremes = Extremes(speed);
        }
        extremes.add(k);
        while (!band.holds(extremes.lowest(), extremes.highest())) extremes.drop_before(++first);
    }
    close(speed.size());
    return windows;
}

/// The longest window, then the longest of those that do not overlap it, and so on; in time order.
std::vector<Window> longest_apart(const std::vector<Window>& windows, const TraceView& trace,
                                  const SteadyRule& rule) {
    std::priority_queue<Window> queue(std::less<Window>{}, windows);
    std::map<std::size_t, Window> taken;  // by first sample
    while (!queue.empty()) {
        Window window = queue.top();
        queue.pop();
        const Window before = window;
        auto next = taken.lower_bound(window.first);
        if (next != taken.begin())
            window.first = std::max(window.first, std::min(std::prev(next)->second.end, window.end));
        if (next != taken.end())
            window.end = std::max(window.first, std::min(window.end, next->second.first));
        if (!long_enough(window, trace, rule)) continue;
        if (window.count() < before.count()) {
            queue.push(window);
        } else {
            taken.emplace(window.first, window);
        }
    }
    std::vector<Window> result;
    for (const auto& [first, window] : taken) result.push_back(window);
    return result;
}

double mean_of(std::span<const double> values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

Stretch measured(const TraceView& trace, std::size_t first, std::size_t count, const SteadyRule& rule) {
    const TraceView part = trace.part(first, count);
    StretchMeter meter(count, Seconds(mean_of(part.time_s)),
                       Degrees(part.has_position() ? mean_of(part.position_deg) : 0.0));
    meter.add(part);
    Stretch stretch = meter.stretch(trace.sample_rate, rule);
    stretch.first = first;
    return stretch;
}

/// Standard deviation of what changes from sample to sample, spikes and steps aside.
double white_noise_of(std::span<const double> values) {
    if (values.size() < 2) return 0.0;
    std::vector<double> changes(values.size() - 1);
    for (std::size_t k = 0; k < changes.size(); ++k) changes[k] = std::abs(values[k + 1] - values[k]);
    return deviations_of_median * median_in(changes) / std::sqrt(2.0);
}

/// True when values range no further than a few times their white noise.
bool only_trembles(std::span<const double> values) {
    constexpr double trembling = 8.0;  // the range of thousands of draws, in deviations
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    return *high - *low <= trembling * white_noise_of(values);
}

/// The angle varies no more than its noise: a few times its own deviation where it is measured, `walk_deg` as
/// integrated velocity.
bool moves_nowhere(const TraceView& trace, double walk_deg) {
    if (trace.has_position() && only_trembles(trace.position_deg)) return true;
    double angle = 0.0, lowest = 0.0, highest = 0.0;
    for (const double v : trace.velocity_deg_s) {
        angle += v / trace.sample_rate.value();
        lowest = std::min(lowest, angle);
        highest = std::max(highest, angle);
    }
    return highest - lowest <= walk_deg;
}

}  // namespace

std::vector<double> moving_mean(std::span<const double> values, std::size_t width) {
    const std::size_t n = values.size();
    const std::size_t half = width / 2;
    std::vector<double> mean(n);
    double sum = 0.0;
    std::size_t from = 0, to = 0;
    for (std::size_t k = 0; k < n; ++k) {
        // Shrinks symmetrically at the ends, so that a ramp is not bent there.
        const std::size_t reach = std::min({half, k, n - 1 - k});
        while (to < k + reach + 1) sum += values[to++];
        while (to > k + reach + 1) sum -= values[--to];
        while (from < k - reach) sum -= values[from++];
        mean[k] = sum / static_cast<double>(to - from);
    }
    return mean;
}

double standstill_deg_s(const TraceView& trace, std::span<const double> smoothed_speed,
                        const SteadyRule& rule) {
    double fastest = 0.0;
    for (const double v : smoothed_speed) fastest = std::max(fastest, std::abs(v));
    const double noise = white_noise_of(trace.velocity_deg_s), step = 1.0 / trace.sample_rate.value();
    constexpr double far = 4.0;  // deviations, once in some thousand draws
    if (moves_nowhere(trace, far * noise * std::sqrt(static_cast<double>(trace.size())) * step))
        return fastest;
    const double left = noise / std::sqrt(std::max(1.0, rule.smoothing.value() / step));
    return std::max(0.01 * rule.rest_percent * fastest, far * left);
}

std::vector<Stretch> steady_stretches(const TraceView& trace, const SteadyRule& rule) {
    std::vector<Stretch> stretches;
    const double rate = trace.sample_rate.value();
    if (trace.size() < 2 || !(rate > 0.0)) return stretches;
    const auto width = static_cast<std::size_t>(rule.smoothing.value() * rate) | 1U;
    const std::vector<double> speed = moving_mean(trace.velocity_deg_s, width);
    const Band band{0.01 * rule.band_percent, rule.band_deg_s, standstill_deg_s(trace, speed, rule)};
    const double rest = std::max(band.standstill_deg_s, 0.5 * rule.band_deg_s);
    for (const Window& window : longest_apart(maximal_windows(trace, speed, band, rule), trace, rule)) {
        stretches.push_back(measured(trace, window.first, window.end - window.first, rule));
        stretches.back().rest = std::abs(stretches.back().speed.value()) <= rest;
    }
    return stretches;
}

// A place u in a stretch, from 0 to 1, counts u^2 (1 - u)^2 for the slope of the position and u^3 (1 - u)^3
// for the mean velocity: alike, since the slope of an angle weighs the velocity by the integral of its own
// weights. These are near the Hann window's, so that the speed is that of the frequency which a spectrum
// has: with equal weights, the ends of a stretch, where the joint still gains speed, made it up to 1.6e-4
// low.
void StretchMeter::add(const TraceView& rows) {
    if (rows.size() == 0) return;
    if (rows_ == 0) first_s_ = rows.time_s.front();
    last_s_ = rows.time_s.back();
    has_position_ = rows.has_position();
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const double along = (static_cast<double>(rows_) + 0.5) / static_cast<double>(count_);
        const double aside = along * (1.0 - along), weight = aside * aside * aside;
        block_weight_ += weight;
        block_sum_ += weight * rows.velocity_deg_s[k];
        const double change = rows.velocity_deg_s[k] - velocity_deg_s_;
        if (rows_ >= 2) bends_deg_s_ += std::abs(change - change_deg_s_);
        change_deg_s_ = change;
        velocity_deg_s_ = rows.velocity_deg_s[k];
        const double speed = std::abs(rows.velocity_deg_s[k]);
        speeds_ += speed;
        squares_ += speed * speed;
        cubes_ += speed * speed * speed;
        // A stretch of fewer rows than blocks has empty ones.
        for (++rows_; block_ < blocks && rows_ >= end_of(block_);) end_block();
        if (!has_position_) continue;
        slope_.add(rows.time_s[k] - mean_s_, rows.position_deg[k] - mean_position_deg_, aside * aside);
    }
}

void StretchMeter::end_block() {
    const double mean = block_weight_ > 0.0 ? block_sum_ / block_weight_ : 0.0;
    weight_ += block_weight_;
    squared_weight_ += block_weight_ * block_weight_;
    sum_ += block_weight_ * mean;
    square_ += block_weight_ * mean * mean;
    block_weight_ = block_sum_ = 0.0;
    ++block_;
}

/// Mean velocity, its error from the scatter of ten block means, since neighbouring samples are not
/// independent. By their weights six of the ten count, and an error from so few is widened.
void StretchMeter::speed_from_velocity(Stretch& stretch) const {
    if (count_ < blocks) return;
    const double mean = sum_ / weight_, shared = squared_weight_ / (weight_ * weight_);
    const double variance = std::max(0.0, square_ / weight_ - mean * mean) / (1.0 - shared);
    stretch.speed = DegPerSec(mean);
    stretch.speed_error_deg_s = few_blocks * std::sqrt(variance * shared);
}

void StretchMeter::Slope::add(double t, double p, double weight) {
    sum_ += weight;
    t_ += weight * t;
    p_ += weight * p;
    tt_ += weight * t * t;
    tp_ += weight * t * p;
    pp_ += weight * p * p;
    square_t_ += weight * weight * t * t;
}

/// Slope of position over time by weighted least squares, with its standard error.
void StretchMeter::speed_from_position(Stretch& stretch) const {
    if (!(slope_.tt() > 0.0)) return;
    const double slope = slope_.tp() / slope_.tt();
    stretch.speed = DegPerSec(slope);
    // The residual about a straight line is slow (control, encoder): ten independent pieces, not count_.
    const double left = std::max(0.0, slope_.pp() - slope * slope_.tp()) / slope_.weight();
    const double pieces = static_cast<double>(count_) / 10.0;
    stretch.speed_error_deg_s = std::sqrt(left * pieces * slope_.square_t()) / slope_.tt();
}

/// Moments of the speed's size weighted by that size. White noise of variance s adds s to the mean square,
/// and three times s times the mean to the mean cube. It is read from second differences, whose variance is 6
/// s, by their mean size: a single jump must not count, nor a smooth course.
void StretchMeter::turning_speed(Stretch& stretch, Hertz rate) const {
    if (rows_ < 3 || !(speeds_ / rate.value() >= least_turned_deg)) return;
    const double bend = bends_deg_s_ / static_cast<double>(rows_ - 2);
    const double noise = bend * bend * std::numbers::pi / 12.0;
    const double mean = (squares_ - static_cast<double>(rows_) * noise) / speeds_;
    if (!(mean > least_over_noise * std::sqrt(noise))) return;
    stretch.turning_deg_s = mean;
    stretch.turning_spread_deg_s = std::sqrt(std::max(0.0, cubes_ / speeds_ - 3.0 * noise - mean * mean));
}

Stretch StretchMeter::stretch(Hertz rate, const SteadyRule& rule) const {
    Stretch stretch;
    stretch.count = count_;
    stretch.duration = Seconds(count_ == 0 ? 0.0 : last_s_ - first_s_ + 1.0 / rate.value());
    speed_from_velocity(stretch);
    turning_speed(stretch, rate);
    if (!has_position_) return stretch;
    const DegPerSec from_velocity = stretch.speed;
    speed_from_position(stretch);
    // A position that wraps or resets inside the stretch contradicts the velocity; then velocity is trusted.
    const double limit = std::max(rule.band_deg_s, 0.5 * std::abs(from_velocity.value()));
    if (std::abs(stretch.speed.value() - from_velocity.value()) > limit) speed_from_velocity(stretch);
    return stretch;
}

Stretch whole_log(const TraceView& trace) { return measured(trace, 0, trace.size(), SteadyRule{}); }

}  // namespace ripplenotch
