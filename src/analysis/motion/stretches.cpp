// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/stretches.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <queue>
#include <span>
#include <utility>

#include "core/rows/row_facts.hpp"

namespace ripplenotch {

namespace {

constexpr double steady_share = 0.05;      // of the middle speed, to both sides
constexpr double rest_share = 0.01;        // of the highest speed: slower is standstill, whatever the band
constexpr double smoothing_s = 0.1;        // the velocity is averaged over this time, against sensor noise
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
    double standstill_deg_s = 0.0;
    [[nodiscard]] bool holds(double lowest, double highest) const {
        if (std::max(std::abs(lowest), std::abs(highest)) <= standstill_deg_s) return true;
        const double middle = 0.5 * (highest + lowest);
        return 0.5 * (highest - lowest) <= steady_share * std::abs(middle);
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

bool long_enough(const Window& window, const TraceView& trace, Seconds at_least) {
    if (window.end <= window.first) return false;
    const double span =
        trace.time_s[window.end - 1] - trace.time_s[window.first] + 1.0 / trace.sample_rate.value();
    return span >= at_least.value() * (1.0 - 1e-9);
}

/// Every window within the band that can be extended to neither side.
std::vector<Window> maximal_windows(const TraceView& trace, std::span<const double> speed, const Band& band,
                                    Seconds at_least) {
    std::vector<Window> windows;
    Extremes extremes(speed);
    std::size_t first = 0;
    const auto close = [&](std::size_t end) {
        if (const Window window{first, end}; long_enough(window, trace, at_least)) windows.push_back(window);
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
                                  Seconds at_least) {
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
        if (!long_enough(window, trace, at_least)) continue;
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

Stretch measured(const TraceView& trace, std::size_t first, std::size_t count) {
    const TraceView part = trace.part(first, count);
    StretchMeter meter(count, Seconds(mean_of(part.time_s)),
                       Degrees(part.has_position() ? mean_of(part.position_deg) : 0.0));
    meter.add(part);
    Stretch stretch = meter.stretch(trace.sample_rate);
    stretch.first = first;
    return stretch;
}

/// True when values range no further than a few times their white noise, or than two of their least steps.
bool only_trembles(std::span<const double> values) {
    constexpr double trembling = 8.0;  // the range of thousands of draws, in deviations
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    double step = 0.0;
    for (std::size_t k = 1; k < values.size(); ++k) {
        const double size = std::abs(values[k] - values[k - 1]);
        if (size > 0.0 && (step == 0.0 || size < step)) step = size;
    }
    return *high - *low <= std::max(trembling * noise_from_differences(values, 1), 2.0 * step);
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

double standstill_deg_s(const TraceView& trace, std::span<const double> smoothed_speed) {
    const double noise = noise_from_differences(trace.velocity_deg_s, 1),
                 step = 1.0 / trace.sample_rate.value();
    constexpr double far = 4.0;  // deviations, once in some thousand draws
    if (moves_nowhere(trace, far * noise * std::sqrt(static_cast<double>(trace.size())) * step))
        return std::numeric_limits<double>::infinity();
    const double left = noise / std::sqrt(std::max(1.0, smoothing_s / step));
    return std::max(rest_share * fastest_of(smoothed_speed), far * left);
}

std::vector<Stretch> steady_stretches(const TraceView& trace, Seconds at_least) {
    std::vector<Stretch> stretches;
    const double rate = trace.sample_rate.value();
    if (trace.size() < 2 || !(rate > 0.0)) return stretches;
    const auto width = static_cast<std::size_t>(smoothing_s * rate) | 1U;
    const std::vector<double> speed = moving_mean(trace.velocity_deg_s, width);
    const Band band{standstill_deg_s(trace, speed)};
    for (const Window& window :
         longest_apart(maximal_windows(trace, speed, band, at_least), trace, at_least)) {
        stretches.push_back(measured(trace, window.first, window.end - window.first));
        stretches.back().rest = std::abs(stretches.back().speed.value()) <= band.standstill_deg_s;
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

Stretch StretchMeter::stretch(Hertz rate) const {
    Stretch stretch;
    stretch.count = count_;
    stretch.duration = Seconds(count_ == 0 ? 0.0 : last_s_ - first_s_ + 1.0 / rate.value());
    speed_from_velocity(stretch);
    turning_speed(stretch, rate);
    if (!has_position_) return stretch;
    const DegPerSec from_velocity = stretch.speed;
    speed_from_position(stretch);
    // A position that wraps or resets inside the stretch contradicts the velocity; then velocity is trusted.
    const double limit = 0.5 * std::abs(from_velocity.value());
    if (std::abs(stretch.speed.value() - from_velocity.value()) > limit) speed_from_velocity(stretch);
    return stretch;
}

Stretch whole_log(const TraceView& trace) { return measured(trace, 0, trace.size()); }

}  // namespace ripplenotch
