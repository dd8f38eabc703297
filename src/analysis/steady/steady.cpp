// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/steady.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <queue>

#include "ripplenotch/core/median.hpp"

namespace ripplenotch {
namespace {

/// Largest and smallest value of a window that only moves forward.
class Extremes {
  public:
    explicit Extremes(std::span<const double> values) : values_(values) {}
    void add(std::size_t k) {
        const double value = values_[k];
        while (!high_.empty() && values_[high_.last()] <= value) high_.drop_last();
        while (!low_.empty() && values_[low_.last()] >= value) low_.drop_last();
        high_.add(k);
        low_.add(k);
    }
    void drop_before(std::size_t k) {
        while (!high_.empty() && high_.first() < k) high_.drop_first();
        while (!low_.empty() && low_.first() < k) low_.drop_first();
    }
    [[nodiscard]] double highest() const { return values_[high_.first()]; }
    [[nodiscard]] double lowest() const { return values_[low_.first()]; }

  private:
    /// Samples that may become the extreme, in their order.
    class Waiting {
      public:
        [[nodiscard]] bool empty() const { return first_ == samples_.size(); }
        [[nodiscard]] std::size_t first() const { return samples_[first_]; }
        [[nodiscard]] std::size_t last() const { return samples_.back(); }
        void add(std::size_t k) { samples_.push_back(k); }
        void drop_last() { samples_.pop_back(); }
        void drop_first() {
            // What is dropped stays until it is half of all.
            if (2 * ++first_ <= samples_.size()) return;
            samples_.erase(samples_.begin(), samples_.begin() + static_cast<std::ptrdiff_t>(first_));
            first_ = 0;
        }

      private:
        std::vector<std::size_t> samples_;
        std::size_t first_ = 0;
    };

    std::span<const double> values_;
    Waiting high_, low_;
};

struct Band {
    double share = 0.0, width_deg_s = 0.0;  // of the middle speed, or absolute
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

/// The longest window, then the longest of what the first leaves of the others, and so on; in time order.
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
    const double range = *high - *low;
    double path = 0.0;
    for (std::size_t k = 1; k < values.size(); ++k) path += std::abs(values[k] - values[k - 1]);
    // A median is at most twice the mean: where that is not enough there is no need for it.
    const auto steps = static_cast<double>(std::max<std::size_t>(values.size(), 2) - 1);
    if (range > trembling * deviations_of_median * std::sqrt(2.0) * path / steps * (1.0 + 1e-9)) return false;
    return range <= trembling * white_noise_of(values);
}

/// The angle goes no further than noise takes it: a few times its own trembling where it is measured,
/// `walk_deg` as integrated velocity.
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

Stretch whole_log(const TraceView& trace) { return measured(trace, 0, trace.size(), SteadyRule{}); }

}  // namespace ripplenotch
