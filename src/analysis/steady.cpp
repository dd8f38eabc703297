// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/steady.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>
#include <map>
#include <numeric>
#include <queue>

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

bool within_band(double lowest, double highest, const SteadyRule& rule) {
    const double middle = 0.5 * (highest + lowest);
    return 0.5 * (highest - lowest) <= std::max(rule.band_deg_s, 0.01 * rule.band_percent * std::abs(middle));
}

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
std::vector<Window> maximal_windows(const TraceView& trace, std::span<const double> speed,
                                    const SteadyRule& rule) {
    std::vector<Window> windows;
    Extremes extremes(speed);
    std::size_t first = 0;
    const double gap = rule.gap_steps / trace.sample_rate.value();
    const auto close = [&](std::size_t end) {
        if (const Window window{first, end}; long_enough(window, trace, rule)) windows.push_back(window);
    };
    extremes.add(0);
    for (std::size_t k = 1; k < speed.size(); ++k) {
        const bool jumped = trace.time_s[k] - trace.time_s[k - 1] > gap;
        const double lowest = std::min(extremes.lowest(), speed[k]);
        const double highest = std::max(extremes.highest(), speed[k]);
        if (jumped || !within_band(lowest, highest, rule)) close(k);
        if (jumped) {
            first = k;
            extremes = Extremes(speed);
        }
        extremes.add(k);
        while (!within_band(extremes.lowest(), extremes.highest(), rule)) extremes.drop_before(++first);
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
    StretchMeter meter(count, mean_of(part.time_s), part.has_position() ? mean_of(part.position_deg) : 0.0);
    meter.take(part);
    Stretch stretch = meter.stretch(trace.sample_rate, rule);
    stretch.first = first;
    return stretch;
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

std::vector<Stretch> steady_stretches(const TraceView& trace, const SteadyRule& rule) {
    std::vector<Stretch> stretches;
    const double rate = trace.sample_rate.value();
    if (trace.size() < 2 || !(rate > 0.0)) return stretches;
    const auto width = static_cast<std::size_t>(rule.smoothing.value() * rate) | 1U;
    const std::vector<double> speed = moving_mean(trace.velocity_deg_s, width);
    for (const Window& window : longest_apart(maximal_windows(trace, speed, rule), trace, rule)) {
        stretches.push_back(measured(trace, window.first, window.end - window.first, rule));
        stretches.back().rest = std::abs(stretches.back().speed.value()) <= 0.5 * rule.band_deg_s;
    }
    return stretches;
}

Stretch whole_log(const TraceView& trace) { return measured(trace, 0, trace.size(), SteadyRule{}); }

bool whole_log_is_steady(const TraceView& trace, const std::vector<Stretch>& stretches) {
    return std::any_of(stretches.begin(), stretches.end(),
                       [&](const Stretch& stretch) { return 10 * stretch.count >= 9 * trace.size(); });
}

}  // namespace ripplenotch
