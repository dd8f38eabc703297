// SPDX-License-Identifier: MIT
#include "analysis/track/ripple_estimate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

#include "analysis/shared_limits.hpp"
#include "analysis/track/order_track.hpp"
#include "ripplenotch/analysis/line_test.hpp"
#include "ripplenotch/analysis/ripple_estimate.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {

namespace {

/// Correlation of the noise in neighbouring Hann windows that overlap by half (Welch 1967).
constexpr double window_correlation = 1.0 / 6.0;

constexpr double fewest_periods = 4.0;  // per segment: fewer are not distinguished from the trend
// Turns of the motor: a resolution at which the families of both splines, Kg and Kg + 1 times per output
// turn, are one line.
constexpr double window_turns = 8.0;
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
    longest_turns_ =
        orders_.empty() ? window_turns : std::max(window_turns, separating_window_turns(orders_));
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
        courses_.assign(orders_.size(), {std::vector<double>(rows.size()), std::vector<double>(rows.size())});
    double fastest = 0.0;
    for (const double speed : part.speed_deg_s) fastest = std::max(fastest, std::abs(speed));
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
            const double cycles = orders_[i] * turns[k], weight = root_weight[k] * root_weight[k];
            const auto on_circle = portable::phasor(2.0 * std::numbers::pi * (cycles - std::floor(cycles)));
            courses_[i].nm[window.first + k] += weight * (found.value.front() * on_circle).real();
            courses_[i].weight[window.first + k] += weight;
        }
        gathered_[i].segments.push_back(std::move(found));
        gathered_[i].absolute_angle = gathered_[i].absolute_angle && part.absolute_angle;
    }
    if (options_.residuals && (shared || last == 0)) measure_residuals(fit, torques);
}

void RippleSegments::measure_residuals(const WindowFit& fit, std::span<const WindowFit::Torque> torques) {
    const std::vector<double> first_trend = fit.trend_in_sum(torques.front());
    for (std::size_t j = 0; j < torques.size(); ++j) {
        SegmentResidual found;
        found.weight = fit.weight();
        const std::vector<double> trend = fit.trend_in_sum(torques[j]);
        for (std::size_t k = 0; k < trend.size(); ++k)
            found.moved_nm2 += (trend[k] - first_trend[k]) * (trend[k] - first_trend[k]) / found.weight;
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

namespace {

constexpr double agreeing_share = 0.5;  // share of the power that segments have in common, for a phase
constexpr double normal_99 = 2.3263478740408408;  // one-sided quantile of 0.99
constexpr double independent_spacing = 1.5;       // in bins under a Hann window
// Efficiency of a median relative to a mean, as in exceedance().
constexpr double median_knowledge_of_mean = 0.48;

/// Mean power near an order, scaled as the fit of the order receives it, and from how many independent bins.
struct NoisePower {
    double power = 0.0, bins = 0.0;
    /// Between both sides along the slope of the spectrum, where that is more.
    double along_slope = 0.0;
};

NoisePower noise_power(const OrderSegments& order, double averages) {
    std::vector<double> powers, sides[2];
    for (std::size_t p = 0; p < 2 * probes_a_side; ++p) {
        double sum = 0.0, weight = 0.0;
        for (const SegmentAmplitude& one : order.segments) {
            if (!std::isfinite(one.noise[p])) continue;
            sum += one.place.weight * one.inflation * one.noise[p];
            weight += one.place.weight;
        }
        if (!(weight > 0.0)) continue;
        powers.push_back(sum / weight);
        sides[p % 2].push_back(sum / weight);
    }
    if (powers.empty()) return {};
    NoisePower noise{median_in(powers) / median_over_mean(averages),
                     static_cast<double>(powers.size()) / independent_spacing};
    noise.along_slope = noise.power;
    if (!sides[0].empty() && !sides[1].empty()) {
        const double between = std::sqrt(median_in(sides[0]) * median_in(sides[1]));
        noise.along_slope = std::max(noise.power, between / median_over_mean(averages));
    }
    return noise;
}

/// Equivalent number of segments of equal noise power: slow ones often hold far more than others.
double effective_averages(const OrderSegments& order) {
    double sum = 0.0, squares = 0.0;
    for (const SegmentAmplitude& one : order.segments) {
        double power = 0.0, count = 0.0;
        for (const double noise : one.noise) {
            if (!std::isfinite(noise)) continue;
            power += noise;
            count += 1.0;
        }
        const double share = count > 0.0 ? one.place.weight * one.inflation * power / count : 0.0;
        sum += share;
        squares += share * share;
    }
    return squares > 0.0 ? sum * sum / squares : 1.0;
}

/// The power over the noise that noise alone exceeds with a probability.
double threshold(double averages, double bins, double false_alarm) {
    double low = 1.0, high = 2.0;
    const auto chance = [&](double ratio) {
        return exceedance({.ratio = ratio, .averages = averages, .cells = median_efficiency * bins});
    };
    while (chance(high) > false_alarm && high < 1e12) high *= 2.0;
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        (chance(middle) > false_alarm ? low : high) = middle;
    }
    return high;
}

}  // namespace

RippleEstimate estimate_of(double value, const OrderSegments& order, std::size_t tries_of_all,
                           double least_nm) {
    RippleEstimate found;
    found.order = value;
    found.segments = order.segments.size();
    found.slowest_deg_s = order.segments.front().place.slowest_deg_s;
    double weight = 0.0, power = 0.0;
    std::complex<double> sum;
    for (const SegmentAmplitude& one : order.segments) {
        found.cycles += value * one.place.turns;
        found.slowest_deg_s = std::min(found.slowest_deg_s, one.place.slowest_deg_s);
        found.fastest_deg_s = std::max(found.fastest_deg_s, one.place.fastest_deg_s);
        weight += one.place.weight;
        power += one.place.weight * std::norm(one.value.front());
        sum += one.place.weight * one.value.front();
    }
    const double averages = effective_averages(order);
    power /= weight;
    sum /= weight;
    const NoisePower noise = noise_power(order, averages);
    if (!(noise.bins > 0.0)) {
        found.insufficient = "no free order next to it to estimate the noise at";
        return found;
    }
    double scatter = 0.0;
    for (const SegmentAmplitude& one : order.segments) {
        const double apart = one.place.weight / weight * (std::norm(one.value.front()) - power);
        scatter += apart * apart;
    }
    scatter *= 1.0 + 2.0 * window_correlation;
    if (averages > 1.5) scatter *= averages / (averages - 1.0);
    const double square = std::max(power - noise.power, 0.0);
    const double variance =
        (2.0 * (1.0 + 2.0 * window_correlation) * square * noise.power + noise.power * noise.power) /
            averages +
        noise.power * noise.power / (averages * noise.bins);
    found.amplitude_nm = std::sqrt(square);
    found.standard_error_nm = std::sqrt(square + std::sqrt(std::max(variance, scatter))) - found.amplitude_nm;
    const double tries = static_cast<double>(tries_of_all);
    found.false_alarm = noise.power > 0.0
                            ? std::min(1.0, tries * exceedance({.ratio = power / noise.along_slope,
                                                                .averages = averages,
                                                                .cells = median_efficiency * noise.bins}))
                            : (power > 0.0 ? 0.0 : 1.0);
    // Power of line and noise is about normal, of variance (2 A^2 N + N^2) / averages, and so is the
    // logarithm of the noise, estimated from the bins to one side, in this log and in the one that the limit
    // applies to: the A^2 at which the lower percentile of the power is the threshold solves a quadratic.
    const double level = threshold(averages, noise.bins, ripple_false_alarm / tries);
    const double above = level - noise.power / std::max(noise.along_slope, 1e-300);
    const double known = 0.5 * median_knowledge_of_mean * noise.bins * averages;
    const double spread = normal_99 * normal_99 / averages;
    const double doubt = portable::pow(level * (portable::exp(normal_99 * std::sqrt(2.0 / known)) - 1.0), 2);
    const double least = above + spread + std::sqrt(2.0 * above * spread + spread * spread + spread + doubt);
    found.detectable_nm = std::max(std::sqrt(noise.along_slope * least), least_nm);
    if (found.amplitude_nm < least_nm) found.false_alarm = 1.0;
    const double common = std::norm(sum);
    if (order.absolute_angle && common > agreeing_share * power && square > 0.0) {
        const double apart = std::max(noise.power, power - common);
        found.phase_deg = portable::atan2(sum.imag(), sum.real()) * degrees_per_radian;
        found.phase_standard_error_deg = std::sqrt(apart / (2.0 * averages * common)) * degrees_per_radian;
    }
    return found;
}

namespace {

std::string why_none(const RippleSegments& all, Order order) {
    const OrderSegments& segments = all.of(order);
    if (segments.few_samples) return "too few samples per motor turn for so many orders";
    if (segments.collinear)
        return "the joint nowhere turns far enough in one direction to separate it from its neighbours";
    const std::string where =
        all.limit_deg_s(order) <= all.fastest_deg_s()
            ? fmt::format("below {:.3g} deg/s, where it lies under half the sample rate, ",
                          all.limit_deg_s(order))
            : "";
    return where + "the joint nowhere turns four periods of it in one direction";
}

}  // namespace

std::vector<RippleEstimate> estimate_ripple(std::span<const TraceView> logs, GearRatio ratio,
                                            std::span<const Order> orders) {
    RippleSegments all(ratio, orders, {.noise = true});
    for (const TraceView& log : logs) all.add(log);
    const double least_nm = least_amplitude_nm(logs, least_range_share);
    std::vector<RippleEstimate> found;
    for (const Order order : orders) {
        const OrderSegments& segments = all.of(order);
        if (!segments.segments.empty()) {
            found.push_back(estimate_of(order.value(), segments, all.orders(), least_nm));
            continue;
        }
        found.emplace_back().order = order.value();
        found.back().insufficient = why_none(all, order);
    }
    return found;
}

RippleCourse ripple_course(const TraceView& log, GearRatio ratio, std::span<const Order> orders) {
    RippleSegments all(ratio, orders, {.courses = true});
    all.add(log);
    RippleCourse course{std::vector<double>(log.size()), std::vector<bool>(log.size())};
    for (const RippleSegments::Course& one : all.courses()) {
        for (std::size_t k = 0; k < log.size(); ++k) {
            if (!(one.weight[k] > 0.0)) continue;
            course.nm[k] += one.nm[k] / one.weight[k];
            course.known[k] = true;
        }
    }
    for (std::size_t from = 0; from < log.size();) {
        std::size_t to = from;
        while (to < log.size() && !course.known[to] && (to == from || !log.starts_run(to))) ++to;
        if (to == from) {
            ++from;
            continue;
        }
        const bool before = from > 0 && !log.starts_run(from), after = to < log.size() && !log.starts_run(to);
        const double first = before ? course.nm[from - 1] : after ? course.nm[to] : 0.0;
        const double last = after ? course.nm[to] : first;
        const double steps = static_cast<double>(to - from + 1);
        for (std::size_t k = from; k < to; ++k)
            course.nm[k] = first + (last - first) * static_cast<double>(k - from + 1) / steps;
        from = to;
    }
    return course;
}

std::string ripple_text(std::span<const RippleEstimate> estimates) {
    std::string text;
    for (const RippleEstimate& one : estimates) {
        if (!text.empty()) text += "; ";
        text += fmt::format("order {}: ", shortest(one.order));
        if (!one.searched()) {
            text += one.insufficient;
            continue;
        }
        text += one.present() ? fmt::format("{:.3g} +/- {:.1g} Nm", one.amplitude_nm, one.standard_error_nm)
                              : fmt::format("no ripple above {:.2g} Nm", one.detectable_nm);
        text += fmt::format(" at {:.3g} to {:.3g} deg/s", one.slowest_deg_s, one.fastest_deg_s);
    }
    return text;
}

}  // namespace ripplenotch
