// SPDX-License-Identifier: MIT
#include "analysis/track/ripple_segments.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

#include "core/rows/row_facts.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {

namespace {

constexpr double fewest_periods = 4.0;  // per segment: fewer are not distinguished from the trend
// Of the lowest line, so that it does not depend on the ratio that names it: a resolution at which the
// families of both splines, Kg and Kg + 1 times per output turn, are one line.
constexpr double window_periods = 8.0;
// Chosen, not derived: bounds cost and memory. Where there are more, every second segment is dropped, and as
// many of those that follow.
constexpr std::size_t most_ripple_samples = 300'000;
// Variance inflation by neighbouring orders and the trend; chosen, not derived.
constexpr double largest_inflation = 10.0;
constexpr std::size_t parts_of_window = 16;  ///< in each of which the gain of a filter counts as constant
// A bin 1.5 resolutions away has 3 % of a Hann line's power.
constexpr double nearest_probe = 1.5;

template <class Value>
void drop_every_second(std::vector<Value>& values) {
    for (std::size_t i = 1; 2 * i < values.size(); ++i) values[i] = std::move(values[2 * i]);
    values.resize((values.size() + 1) / 2);
}

double peak_to_peak(const std::vector<double>& values) {
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    return values.empty() ? 0.0 : *high - *low;
}

}  // namespace

/// The motion of some rows.
struct RippleSegments::Part {
    const TraceView& rows;
    std::vector<std::span<const double>> torques;
    std::vector<double> turns, speed_deg_s;  ///< turns of the motor; speed of the joint
    bool absolute_angle = false;

    /// Motion in one direction, slower than a speed.
    [[nodiscard]] std::vector<SampleRun> slower_runs(double limit_deg_s) const {
        std::vector<SampleRun> slower;
        for (const SampleRun& run : directed_runs(speed_deg_s, rows.run_starts, {})) {
            bool inside = false;
            for (std::size_t k = run.first; k < run.end; ++k) {
                const bool slow = std::abs(speed_deg_s[k]) < limit_deg_s;
                if (slow && !inside) slower.push_back({k, k});
                if (slow) slower.back().end = k + 1;
                inside = slow;
            }
        }
        return slower;
    }
};

RippleSegments::RippleSegments(GearRatio ratio, std::span<const Order> orders, Options options)
    : ratio_(ratio.value()), options_(std::move(options)), residuals_(options_.signals) {
    if (!(ratio_ > 0.0)) raise<UsageError>("gear ratio {} is not above 0", shortest(ratio_));
    for (const Order order : orders) {
        if (!(order.value() > 0.0)) raise<UsageError>("order {} is not above 0", shortest(order.value()));
        asked_.push_back(order.value());
    }
    orders_ = asked_;
    std::sort(orders_.begin(), orders_.end());
    orders_.erase(std::unique(orders_.begin(), orders_.end()), orders_.end());
    longest_turns_ = orders_.empty()
                         ? window_periods
                         : std::max(window_periods / orders_.front(), separating_window_turns(orders_));
    gathered_.resize(orders_.size());
}

const OrderSegments& RippleSegments::of(Order order) const {
    const auto at = std::lower_bound(orders_.begin(), orders_.end(), order.value());
    return gathered_[static_cast<std::size_t>(at - orders_.begin())];
}

bool RippleSegments::keeps(std::size_t samples) {
    if (seen_++ % stride_ != 0) return false;
    samples_ += samples;
    if (samples_ <= most_ripple_samples) return true;
    for (OrderSegments& order : gathered_) drop_every_second(order.segments);
    for (std::vector<SegmentResidual>& signal : residuals_) drop_every_second(signal);
    stride_ *= 2;
    samples_ /= 2;
    return true;
}

// Orders that stay below half the sample rate share their segments; each other one has its own.
std::size_t RippleSegments::add(const TraceView& rows, std::span<const std::span<const double>> further,
                                std::size_t seen_before) {
    if (rows.size() == 0) return 0;
    OutputAngle angle = output_angle(rows);
    for (double& turns : angle.turns) turns *= ratio_;
    Part part{rows, {rows.torque_nm}, std::move(angle.turns), smoothed_speed(rows), angle.absolute};
    part.torques.insert(part.torques.end(), further.begin(), further.end());
    if (options_.courses)
        courses_.assign(orders_.size(),
                        {std::vector<std::complex<double>>(rows.size()), std::vector<double>(rows.size())});
    const double fastest = fastest_of(part.speed_deg_s);
    fastest_deg_s_ = std::max(fastest_deg_s_, fastest);
    rate_turns_deg_s_ = std::min(rate_turns_deg_s_, 360.0 * rows.sample_rate.value() / ratio_);
    bool shared = false;
    for (std::size_t last = orders_.size(); last-- > 0 && !shared;) {
        shared = limit_deg_s(Order(orders_[last])) > fastest;
        const double slower = shared ? 2.0 * fastest : limit_deg_s(Order(orders_[last]));
        for (const SampleRun& run : part.slower_runs(slower)) {
            for (const SampleRun& window :
                 cut_windows(run, part.turns, longest_turns_, fewest_periods / orders_[last], 0.5)) {
                if (window.size() < 3) continue;
                if (shared || last == 0) {
                    rows_ += window.end - std::min(std::max(window.first, seen_before), window.end);
                    seen_before = std::max(seen_before, window.end);
                }
                if (options_.courses || keeps(window.size())) measure(part, window, last, shared);
            }
        }
    }
    const auto runs = part.slower_runs(2.0 * fastest);
    std::size_t from = rows.size();
    if (!runs.empty() && runs.back().end == rows.size()) {
        while (from > runs.back().first &&
               std::abs(part.turns.back() - part.turns[from - 1]) <= 0.5 * longest_turns_)
            --from;
    }
    return from;
}

void RippleSegments::measure(const Part& part, const SampleRun& window, std::size_t last, bool shared) {
    const auto turns = std::span(part.turns).subspan(window.first, window.size());
    const auto speeds = std::span(part.speed_deg_s).subspan(window.first, window.size());
    const double length = std::abs(turns.back() - turns.front());
    std::vector<TrackedLine> lines;
    const auto first = std::lower_bound(orders_.begin(), orders_.end(), fewest_periods / length);
    const auto skipped = static_cast<std::size_t>(first - orders_.begin());
    for (std::size_t i = skipped; i <= last; ++i) lines.push_back({orders_[i], turns});
    if (lines.empty()) return;
    SegmentPlace place{0.0, length, part.rows.time_s[window.end - 1] - part.rows.time_s[window.first],
                       std::numeric_limits<double>::max(), 0.0};
    std::vector<double> root_weight;
    double weighted_speed = 0.0;
    for (std::size_t k = 0; k < window.size(); ++k) {
        const double u = std::clamp(std::abs(turns[k] - turns.front()) / length, 0.0, 1.0);
        const double speed = std::abs(speeds[k]);  // angle per sample, up to a factor
        root_weight.push_back(std::sqrt(speed) * portable::sin(std::numbers::pi * u));
        place.slowest_deg_s = std::min(place.slowest_deg_s, speed);
        place.fastest_deg_s = std::max(place.fastest_deg_s, speed);
        weighted_speed += root_weight.back() * root_weight.back() * speeds[k];
    }
    WindowFit fit(turns, root_weight, length / ratio_, lines, 0);
    place.weight = fit.weight();
    place.mean_deg_s = weighted_speed / place.weight;
    const std::size_t from = shared ? skipped : last;
    if (!fit.has_enough_samples()) {
        for (std::size_t i = from; i <= last; ++i) gathered_[i].few_samples = true;
        ++too_few_samples_;
        return;
    }
    fit.factorise();
    std::vector<WindowFit::Torque> torques;
    for (const auto torque : part.torques)
        torques.push_back(fit.fit(torque.subspan(window.first, window.size())));
    const std::vector<double> gains = expected_gains(part, window);
    for (std::size_t i = from; i <= last; ++i) {
        const std::size_t line = i - skipped;
        if (!(fit.inflation(line) < largest_inflation)) {
            gathered_[i].collinear = true;
            continue;
        }
        SegmentAmplitude found{place, {}, fit.inflation(line), gains[i], {}};
        for (const WindowFit::Torque& torque : torques) found.value.push_back(fit.amplitude(torque, line));
        for (std::size_t p = 0; options_.noise && p < found.noise.size(); ++p) {
            const double apart = (nearest_probe + static_cast<double>(p / 2)) / length;
            found.noise[p] = fit.power_beside(
                torques.front(), {orders_[i] + (p % 2 == 0 ? -apart : apart), turns}, nearest_probe);
        }
        for (std::size_t k = 0; options_.courses && k < window.size(); ++k) {
            const double weight = root_weight[k] * root_weight[k];
            courses_[i].amplitude[window.first + k] += weight * found.value.front();
            courses_[i].weight[window.first + k] += weight;
        }
        gathered_[i].segments.push_back(std::move(found));
        gathered_[i].absolute_angle = gathered_[i].absolute_angle && part.absolute_angle;
    }
    if (options_.residuals && (shared || last == 0)) measure_residuals(fit, torques);
}

void RippleSegments::measure_residuals(const WindowFit& fit, std::span<const WindowFit::Torque> torques) {
    for (std::size_t j = 0; j < torques.size(); ++j) {
        SegmentResidual found;
        found.weight = fit.weight();
        std::vector<double> detrended, ripple = fit.lines_in_sum(torques[j]);
        for (std::size_t k = 0; k < ripple.size(); ++k) {
            const double all = ripple[k] + torques[j].residual[k];
            found.square_nm2 += all * all / found.weight;
            detrended.push_back(all);
        }
        found.peak_to_peak_nm = peak_to_peak(fit.middle_half(detrended));
        found.ripple_peak_to_peak_nm = peak_to_peak(fit.middle_half(ripple));
        residuals_[j].push_back(found);
    }
}

// The fit of a segment gives the mean of the filtered line's amplitude and phase under its window.
std::vector<double> RippleSegments::expected_gains(const Part& part, const SampleRun& window) const {
    std::vector<double> gains(orders_.size(), 0.0);
    if (!options_.gains) return gains;
    const std::size_t steps = window.size() - 1, parts = std::min(parts_of_window, steps);
    std::vector<std::complex<double>> now(asked_.size()), sum(asked_.size());
    const double start = part.turns[window.first], length = part.turns[window.end - 1] - start;
    double weights = 0.0;
    for (std::size_t i = 0; i < parts; ++i) {
        const std::size_t first = window.first + steps * i / parts;
        const std::size_t end = window.first + steps * (i + 1) / parts;
        const double turned = std::abs(part.turns[end] - part.turns[first]);
        const double place = (0.5 * (part.turns[end] + part.turns[first]) - start) / length;
        const double weight = turned * portable::pow(portable::sin(std::numbers::pi * place), 2);
        options_.gains(turned * 360.0 / ratio_ / (part.rows.time_s[end] - part.rows.time_s[first]), now);
        for (std::size_t j = 0; j < now.size(); ++j) sum[j] += weight * now[j];
        weights += weight;
    }
    for (std::size_t j = 0; j < sum.size(); ++j) {
        const auto at = std::lower_bound(orders_.begin(), orders_.end(), asked_[j]) - orders_.begin();
        gains[static_cast<std::size_t>(at)] = std::abs(sum[j]) / weights;
    }
    return gains;
}

}  // namespace ripplenotch
