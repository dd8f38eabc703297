// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/ripple_estimate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "analysis/track/ripple_segments.hpp"
#include "ripplenotch/analysis/line_test.hpp"
#include "ripplenotch/analysis/sweeps.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {

namespace {

/// Amplitude below which a ripple does not count, as a share of the torque's range; as
/// MotionLinesOptions::least_share.
constexpr double least_range_share = 1e-4;
/// Correlation of the noise in neighbouring Hann windows that overlap by half (Welch 1967).
constexpr double window_correlation = 1.0 / 6.0;
constexpr double agreeing_share = 0.5;  // share of the power that segments have in common, for a phase
constexpr double normal_99 = 2.3263478740408408;  // one-sided quantile of 0.99
constexpr double independent_spacing = 1.5;       // in bins under a Hann window

/// Mean power near an order, scaled as the fit of the order receives it, and from how many independent bins.
struct NoisePower {
    double power = 0.0, bins = 0.0;
    /// Between both sides along the slope of the spectrum, where that is more.
    double along_slope = 0.0;
};

/// Noise power of a segment at its order, the mean of the probes, but for one; 0 where there are none.
double noise_of(const SegmentAmplitude& one, std::size_t without = 2 * probes_a_side) {
    double power = 0.0, count = 0.0;
    for (std::size_t p = 0; p < one.noise.size(); ++p) {
        if (p == without || !std::isfinite(one.noise[p])) continue;
        power += one.inflation * one.noise[p];
        count += 1.0;
    }
    return count > 0.0 ? power / count : 0.0;
}

/// How much a segment counts: by its angle, and the less the more of its power is noise. `ripple` is the
/// power that the segments have in common. The noise is that of the other probes, so that a probe and the
/// order are weighed alike: where there is no ripple their sums have one distribution.
double weight_of(const SegmentAmplitude& one, double ripple, std::size_t without = 2 * probes_a_side) {
    const double all = noise_of(one, without) + ripple;
    return all > 0.0 ? one.place.weight / all : 0.0;
}

NoisePower noise_power(const OrderSegments& order, double averages, double ripple) {
    std::vector<double> powers, sides[2];
    for (std::size_t p = 0; p < 2 * probes_a_side; ++p) {
        double sum = 0.0, weights = 0.0;
        for (const SegmentAmplitude& one : order.segments) {
            if (!std::isfinite(one.noise[p])) continue;
            const double weight = weight_of(one, ripple, p);
            sum += weight * one.inflation * one.noise[p];
            weights += weight;
        }
        if (!(weights > 0.0)) continue;
        powers.push_back(sum / weights);
        sides[p % 2].push_back(sum / weights);
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

/// Equivalent number of segments of equal noise power. A weight whose noise is known from few probes
/// fluctuates by itself: with the inverse of a chi-square variable, whose relative variance is 2 / (d - 4) on
/// d degrees of freedom, two for each independent bin.
double effective_averages(const OrderSegments& order, double ripple) {
    double sum = 0.0, squares = 0.0, fluctuating = 0.0;
    for (const SegmentAmplitude& one : order.segments) {
        const double noise = noise_of(one);
        const double share = weight_of(one, ripple) * noise;
        if (!(share > 0.0)) continue;
        const auto probes = std::count_if(one.noise.begin(), one.noise.end(),
                                          [](double power) { return std::isfinite(power); });
        const double freedom = 2.0 * static_cast<double>(probes) / independent_spacing;
        const double of_weight = noise / (noise + ripple);
        sum += share;
        squares += share * share;
        fluctuating += share * share * (1.0 + of_weight * of_weight * 2.0 / std::max(freedom - 4.0, 1.0));
    }
    return squares > 0.0 ? 1.0 + (sum * sum - squares) / fluctuating : 1.0;
}

/// Power and mean of the segments, the noise at their order, and how many equal segments they stand for.
struct SegmentSum {
    double power = 0.0, averages = 1.0;
    std::complex<double> mean;
    NoisePower noise;
    double scatter = 0.0;  ///< variance of the power, as the segments differ
};

SegmentSum sum_of(const OrderSegments& order, double ripple) {
    SegmentSum found;
    double weights = 0.0;
    for (const SegmentAmplitude& one : order.segments) {
        const double weight = weight_of(one, ripple);
        weights += weight;
        found.power += weight * std::norm(one.value.front());
        found.mean += weight * one.value.front();
    }
    if (!(weights > 0.0)) return found;
    found.power /= weights;
    found.mean /= weights;
    found.averages = effective_averages(order, ripple);
    found.noise = noise_power(order, found.averages, ripple);
    for (const SegmentAmplitude& one : order.segments) {
        const double apart = weight_of(one, ripple) / weights * (std::norm(one.value.front()) - found.power);
        found.scatter += apart * apart;
    }
    found.scatter *= 1.0 + 2.0 * window_correlation;
    if (found.averages > 1.5) found.scatter *= found.averages / (found.averages - 1.0);
    return found;
}

/// The ripple in these segments, which are at least one. `tries_of_all`: estimates of which none may be a
/// false alarm.
RippleEstimate estimate_of(double value, const OrderSegments& order, std::size_t tries_of_all,
                           double least_nm) {
    RippleEstimate found;
    found.order = value;
    found.segments = order.segments.size();
    found.slowest_deg_s = order.segments.front().place.slowest_deg_s;
    for (const SegmentAmplitude& one : order.segments) {
        found.cycles += value * one.place.turns;
        found.slowest_deg_s = std::min(found.slowest_deg_s, one.place.slowest_deg_s);
        found.fastest_deg_s = std::max(found.fastest_deg_s, one.place.fastest_deg_s);
    }
    // The test weighs for a ripple as faint as the noise of the median segment. Windows that overlap count as
    // correlated: counted as independent they give 2 false alarms in 100 logs of coloured noise, not 1.
    std::vector<double> noises;
    for (const SegmentAmplitude& one : order.segments) noises.push_back(noise_of(one));
    const SegmentSum faint = sum_of(order, median_in(noises));
    const NoisePower& noise = faint.noise;
    if (!(noise.bins > 0.0)) {
        found.insufficient = "no free order next to it to estimate the noise at";
        return found;
    }
    const double averages = 1.0 + (faint.averages - 1.0) / (1.0 + 2.0 * window_correlation);
    const double tries = static_cast<double>(tries_of_all);
    const double cells = median_efficiency * noise.bins;
    found.false_alarm = noise.power > 0.0
                            ? std::min(1.0, tries * exceedance({.ratio = faint.power / noise.along_slope,
                                                                .averages = averages,
                                                                .cells = cells}))
                            : (faint.power > 0.0 ? 0.0 : 1.0);
    // Power of line and noise is about normal, of variance (2 A^2 N + N^2) / averages, and so is the
    // logarithm of the noise, estimated from the bins to one side, in this log and in the one that the limit
    // applies to: the A^2 at which the lower percentile of the power is the threshold solves a quadratic.
    const double level = exceeded(ripple_false_alarm / tries, {.averages = averages, .cells = cells});
    const double above = level - noise.power / std::max(noise.along_slope, 1e-300);
    const double known = 0.5 * cells * averages;
    const double spread = normal_99 * normal_99 / averages;
    const double doubt = portable::pow(level * (portable::exp(normal_99 * std::sqrt(2.0 / known)) - 1.0), 2);
    const double least = above + spread + std::sqrt(2.0 * above * spread + spread * spread + spread + doubt);
    found.detectable_nm = std::max(std::sqrt(noise.along_slope * least), least_nm);

    const SegmentSum all = sum_of(order, std::max(faint.power - faint.noise.power, 0.0));
    const double square = std::max(all.power - all.noise.power, 0.0);
    const double variance = (2.0 * (1.0 + 2.0 * window_correlation) * square * all.noise.power +
                             all.noise.power * all.noise.power) /
                                all.averages +
                            all.noise.power * all.noise.power / (all.averages * all.noise.bins);
    found.amplitude_nm = std::sqrt(square);
    found.standard_error_nm =
        std::sqrt(square + std::sqrt(std::max(variance, all.scatter))) - found.amplitude_nm;
    if (found.amplitude_nm < least_nm) found.false_alarm = 1.0;
    const double common = std::norm(all.mean);
    if (order.absolute_angle && common > agreeing_share * all.power && square > 0.0) {
        const double apart = std::max(all.noise.power, all.power - common);
        found.phase_deg = portable::atan2(all.mean.imag(), all.mean.real()) * degrees_per_radian;
        found.phase_standard_error_deg =
            std::sqrt(apart / (2.0 * all.averages * common)) * degrees_per_radian;
    }
    return found;
}

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

namespace {

constexpr std::size_t most_bins = 6;  // chosen, not derived: a course with a maximum shows in as many
// The scatter of n segments gives a standard error within a share of 1 / sqrt(2 (n - 1)) of the true one, a
// third here; the noise near the order is known better, from eight independent frequencies of each segment.
constexpr std::size_t fewest_segments = 6;
// Speeds this close are one stated speed, which the noise of the velocity must not cut in two.
constexpr double same_speed = 1.05;
// Speeds this far from the next are stated ones, which have a range each where there are few.
constexpr double other_speed = 1.1;

/// Segments of one range of |speed|: forward, backward.
using SpeedBin = std::array<OrderSegments, 2>;

std::size_t segments_in(const SpeedBin& bin) { return bin[0].segments.size() + bin[1].segments.size(); }

/// No direction has segments that are too few for an estimate.
bool is_usable(const SpeedBin& bin) {
    return std::all_of(bin.begin(), bin.end(), [](const OrderSegments& one) {
        return one.segments.empty() || one.segments.size() >= fewest_segments;
    });
}

void append(SpeedBin& bin, const SegmentAmplitude& segment) {
    bin[segment.place.mean_deg_s < 0.0 ? 1 : 0].segments.push_back(segment);
}

/// A range for each speed where few are stated, else about equal numbers of segments in each; the same in
/// both directions, so that these are compared at the same speeds.
std::vector<SpeedBin> speed_bins(const OrderSegments& order) {
    std::vector<const SegmentAmplitude*> sorted;
    std::array<std::size_t, 2> of_direction{};
    for (const SegmentAmplitude& one : order.segments) {
        sorted.push_back(&one);
        ++of_direction[one.place.mean_deg_s < 0.0 ? 1 : 0];
    }
    const auto speed = [](const SegmentAmplitude* one) { return std::abs(one->place.mean_deg_s); };
    std::stable_sort(sorted.begin(), sorted.end(),
                     [&](const auto* a, const auto* b) { return speed(a) < speed(b); });
    const std::size_t fewest = fewest_segments * (of_direction[0] > 0 && of_direction[1] > 0 ? 2 : 1);
    std::size_t stated = 1;
    for (std::size_t i = 1; i < sorted.size(); ++i)
        if (speed(sorted[i]) > other_speed * speed(sorted[i - 1])) ++stated;
    std::vector<SpeedBin> bins;
    std::size_t wanted = 0;
    double slowest_alike = 0.0;
    for (std::size_t i = 0; i < sorted.size(); ++i) {
        const double now = speed(sorted[i]);
        const bool differs = now > same_speed * slowest_alike;
        if (differs) slowest_alike = now;
        const auto ends = [&](const SpeedBin& bin) {
            const std::size_t in = segments_in(bin);
            if (stated <= most_bins && now > other_speed * speed(sorted[i - 1]))
                return in >= fewest_segments && is_usable(bin);
            // A direction that is rarer than the other is waited for, but not for long.
            return differs && in >= wanted && (is_usable(bin) || in >= 2 * wanted);
        };
        if (bins.empty() || (bins.size() < most_bins && ends(bins.back()))) {
            wanted = std::max(fewest, (sorted.size() - i) / (most_bins - bins.size()));
            bins.emplace_back();
        }
        append(bins.back(), *sorted[i]);
    }
    while (bins.size() > 1 && !is_usable(bins.back())) {
        for (const OrderSegments& direction : bins.back())
            for (const SegmentAmplitude& one : direction.segments) append(bins[bins.size() - 2], one);
        bins.pop_back();
    }
    return bins;
}

void set_speeds(RippleAtSpeed& at, const OrderSegments& segments, const SpeedBin& bin) {
    double weight = 0.0, sum = 0.0;
    for (const SegmentAmplitude& one : segments.segments) {
        weight += one.place.weight;
        sum += one.place.weight * std::abs(one.place.mean_deg_s);
    }
    at.speed_deg_s = sum / weight;
    at.speed_from_deg_s = at.speed_to_deg_s = at.speed_deg_s;
    for (const OrderSegments& direction : bin) {
        for (const SegmentAmplitude& one : direction.segments) {
            at.speed_from_deg_s = std::min(at.speed_from_deg_s, std::abs(one.place.mean_deg_s));
            at.speed_to_deg_s = std::max(at.speed_to_deg_s, std::abs(one.place.mean_deg_s));
        }
    }
}

}  // namespace

std::vector<RippleAtSpeed> amplitude_by_speed(std::span<const TraceView> logs, GearRatio ratio,
                                              std::span<const Order> orders) {
    RippleSegments all(ratio, orders, {.noise = true});
    for (const TraceView& log : logs) all.add(log);
    const double least_nm = least_amplitude_nm(logs, least_range_share);
    std::vector<std::vector<SpeedBin>> bins;
    std::size_t tries = 0;
    for (const Order order : orders) {
        bins.push_back(speed_bins(all.of(order)));
        tries += 2 * bins.back().size();
    }
    std::vector<RippleAtSpeed> found;
    for (std::size_t i = 0; i < orders.size(); ++i) {
        for (const SpeedBin& bin : bins[i]) {
            for (const int direction : {1, -1}) {
                const OrderSegments& segments = bin[direction < 0 ? 1 : 0];
                if (segments.segments.size() < fewest_segments) continue;
                RippleAtSpeed at{estimate_of(orders[i].value(), segments, tries, least_nm), direction};
                if (!at.ripple.searched()) continue;
                set_speeds(at, segments, bin);
                found.push_back(std::move(at));
            }
        }
    }
    return found;
}

namespace {

// Where no window lies, amplitude and phase are between those of the rows before and after; false where the
// run has no window at all.
bool fill_between(RippleSegments::Course& course, std::size_t first, std::size_t end) {
    std::optional<std::size_t> before;
    for (std::size_t at = first; at <= end; ++at) {
        const bool held = at < end && course.weight[at] > 0.0;
        if (held) course.amplitude[at] /= course.weight[at];
        if (!held && at < end) continue;
        for (std::size_t k = before ? *before + 1 : first; k < at && (before || held); ++k) {
            const auto from = course.amplitude[before.value_or(at)],
                       to = course.amplitude[held ? at : *before];
            const double share =
                before ? static_cast<double>(k - *before) / static_cast<double>(at - *before) : 0.0;
            course.amplitude[k] = from + share * (to - from);
        }
        if (held) before = at;
    }
    return before.has_value();
}

}  // namespace

RippleCourse ripple_course(const TraceView& log, GearRatio ratio, std::span<const Order> orders) {
    RippleSegments all(ratio, orders, {.courses = true});
    all.add(log);
    const OutputAngle angle = output_angle(log);
    RippleCourse found{std::vector<double>(log.size()), std::vector<bool>(log.size(), true)};
    std::size_t i = 0;
    for (RippleSegments::Course course : all.courses()) {
        const double cycles_a_turn = all.order(i++) * ratio.value();
        for (const auto& [first, end] : whole_runs(log.size(), log.run_starts)) {
            const bool known = fill_between(course, first, end);
            for (std::size_t k = first; k < end; ++k) {
                const double cycles = cycles_a_turn * angle.turns[k];
                const auto on_circle =
                    portable::phasor(2.0 * std::numbers::pi * (cycles - std::floor(cycles)));
                found.nm[k] += (course.amplitude[k] * on_circle).real();
                found.known[k] = found.known[k] && known;
            }
        }
    }
    return found;
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
