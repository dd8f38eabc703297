// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/amplitude_by_speed.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "analysis/shared_limits.hpp"
#include "analysis/track/ripple_estimate.hpp"

namespace ripplenotch {

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

}  // namespace ripplenotch
