// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/steady.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
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
        while (!high_.empty() && values_[high_.back()] <= values_[k]) high_.pop_back();
        while (!low_.empty() && values_[low_.back()] >= values_[k]) low_.pop_back();
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
    std::deque<std::size_t> high_, low_;
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
    for (std::size_t k = 1; k < speed.size(); ++k) {
        const bool jumped = trace.starts_run(k);
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
    std::vector<double> changes;
    for (std::size_t k = 1; k < values.size(); ++k) changes.push_back(std::abs(values[k] - values[k - 1]));
    return 1.4826 * median_in(changes) / std::sqrt(2.0);
}

/// The angle goes no further than noise takes it: a few times its own trembling where it is measured,
/// `walk_deg` as integrated velocity.
bool moves_nowhere(const TraceView& trace, double walk_deg) {
    if (trace.has_position()) {
        const auto [low, high] = std::minmax_element(trace.position_deg.begin(), trace.position_deg.end());
        constexpr double trembling = 8.0;  // the range of thousands of draws, in deviations
        if (*high - *low <= trembling * white_noise_of(trace.position_deg)) return true;
    }
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
