// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/amplitude_by_speed.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "analysis/shared_limits.hpp"
#include "analysis/track/ripple_estimate.hpp"
#include "ripplenotch/analysis/line_test.hpp"
#include "ripplenotch/core/number.hpp"

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

// The test of a change.

/// One amplitude with its error.
struct Value {
    const RippleAtSpeed* at = nullptr;
    double nm = 0.0, error = 0.0;
    double freedom = 1.0;  ///< of the error

    [[nodiscard]] double weight() const { return 1.0 / (error * error); }
};

std::vector<Value> values_of(std::span<const RippleAtSpeed> rows) {
    std::vector<Value> values;
    for (const RippleAtSpeed& row : rows) {
        // Without any noise the error is that of the fit: what trend and neighbours leave of it.
        constexpr double of_fit = 1e-3, least_nm = 1e-100;  // chosen, not derived
        const double nm = row.ripple.amplitude_nm;
        values.push_back({&row, nm, std::max({row.ripple.standard_error_nm, of_fit * nm, least_nm}),
                          static_cast<double>(row.ripple.segments - 1)});
    }
    return values;
}

/// A weighted sum of amplitudes whose mean is 0 where they do not differ.
struct Contrast {
    double size = 0.0, variance = 0.0;
    double slack = 0.0;  ///< sum of (share of the variance)^2 / degrees of freedom

    void add(double coefficient, const Value& value) {
        size += coefficient * value.nm;
        const double part = coefficient * coefficient * value.error * value.error;
        variance += part;
        slack += part * part / value.freedom;
    }
    /// By Satterthwaite (1946).
    [[nodiscard]] double freedom() const { return variance * variance / slack; }
    /// Of as large a size where there is no difference: F with one degree of freedom above.
    [[nodiscard]] double chance() const {
        return exceedance({.ratio = size * size / variance, .averages = 0.5, .cells = freedom()});
    }
    /// The size that is found at this false alarm in 95 of 100 logs.
    [[nodiscard]] double detectable(double false_alarm) const {
        constexpr double normal_95 = 1.6448536269514722;
        const double ratio = exceeded(false_alarm, {.averages = 0.5, .cells = freedom()}).ratio;
        return (std::sqrt(ratio) + normal_95) * std::sqrt(variance);
    }
};

/// Slope over speed, with a mean of its own in each direction; empty at one speed.
std::optional<Contrast> trend_of(std::span<const Value> values) {
    std::array<double, 2> weight{}, speed{};
    const auto side = [](const Value& one) -> std::size_t { return one.at->direction < 0 ? 1 : 0; };
    for (const Value& one : values) {
        weight[side(one)] += one.weight();
        speed[side(one)] += one.weight() * one.at->speed_deg_s;
    }
    double spread = 0.0;
    const auto apart = [&](const Value& one) {
        return one.at->speed_deg_s - speed[side(one)] / weight[side(one)];
    };
    for (const Value& one : values) spread += one.weight() * apart(one) * apart(one);
    std::array<std::size_t, 2> count{};
    for (const Value& one : values) ++count[side(one)];
    if ((count[0] < 2 && count[1] < 2) || !(spread > 0.0)) return std::nullopt;
    Contrast slope;
    for (const Value& one : values) slope.add(one.weight() * apart(one) / spread, one);
    return slope;
}

/// Forward and backward at the same speeds, of which the difference has this weight.
struct Pair {
    const Value *forward = nullptr, *backward = nullptr;

    [[nodiscard]] double weight() const { return 1.0 / (1.0 / forward->weight() + 1.0 / backward->weight()); }
};

std::vector<Pair> pairs_of(std::span<const Value> values) {
    std::vector<Pair> pairs;
    for (std::size_t i = 1; i < values.size(); ++i) {
        if (values[i].at->speed_from_deg_s == values[i - 1].at->speed_from_deg_s)
            pairs.push_back({&values[i - 1], &values[i]});
    }
    return pairs;
}

/// Mean difference of the directions at the same speeds; empty without any.
std::optional<Contrast> difference_of(const std::vector<Pair>& pairs) {
    if (pairs.empty()) return std::nullopt;
    double weights = 0.0;
    for (const Pair& pair : pairs) weights += pair.weight();
    Contrast difference;
    for (const Pair& pair : pairs) {
        difference.add(pair.weight() / weights, *pair.forward);
        difference.add(-pair.weight() / weights, *pair.backward);
    }
    return difference;
}

/// That the speeds of one direction differ by chance, whatever the course over speed.
double welch_chance(std::span<const Value> values) {
    const auto k = static_cast<double>(values.size());
    double weight = 0.0, mean = 0.0, scatter = 0.0, slack = 0.0;
    for (const Value& one : values) {
        weight += one.weight();
        mean += one.weight() * one.nm;
    }
    mean /= weight;
    for (const Value& one : values) {
        scatter += one.weight() * (one.nm - mean) * (one.nm - mean);
        slack += (1.0 - one.weight() / weight) * (1.0 - one.weight() / weight) / one.freedom;
    }
    const double ratio = scatter / (k - 1.0) / (1.0 + 2.0 * (k - 2.0) / (k * k - 1.0) * slack);
    const double averages = 0.5 * (k - 1.0), knowledge = 0.5 * (k * k - 1.0) / (3.0 * slack);
    return exceedance({.ratio = ratio, .averages = averages, .cells = knowledge / averages});
}

/// Weighted mean.
double mean_amplitude(std::span<const Value> values) {
    double sum = 0.0, weight = 0.0;
    for (const Value& one : values) {
        sum += one.weight() * one.nm;
        weight += one.weight();
    }
    return sum / weight;
}

std::string chance_text(double chance) {
    // Tails of the approximations above mean nothing beyond.
    constexpr double least = 1e-9;
    return chance < least ? fmt::format("p < {:.0e}", least) : fmt::format("p = {:.1g}", chance);
}

/// The amplitude of one range of speed, over its directions.
struct AtSpeed {
    double speed_deg_s = 0.0, nm = 0.0, error_nm = 0.0;
};

std::vector<AtSpeed> course_of(std::span<const Value> values) {
    std::vector<AtSpeed> course;
    for (std::size_t i = 0; i < values.size();) {
        std::size_t end = i + 1;
        while (end < values.size() && values[end].at->speed_from_deg_s == values[i].at->speed_from_deg_s)
            ++end;
        const auto same = values.subspan(i, end - i);
        double weight = 0.0, speed = 0.0;
        for (const Value& one : same) {
            weight += one.weight();
            speed += one.weight() * one.at->speed_deg_s;
        }
        const double nm = mean_amplitude(same);
        course.push_back({speed / weight, nm, std::sqrt(1.0 / weight)});
        i = end;
    }
    return course;
}

/// "grows with speed: 0.21 Nm at 20 deg/s to 0.38 Nm at 100 deg/s", with the extreme between them where the
/// amplitude there is beyond both by more than its 95 % interval.
std::string course_text(const std::vector<AtSpeed>& course, bool trend, const std::string& where) {
    const AtSpeed &first = course.front(), &last = course.back();
    const AtSpeed* between = nullptr;
    double furthest = 0.0;
    for (const AtSpeed& at : course) {
        const double beyond =
            std::max(at.nm - std::max(first.nm, last.nm), std::min(first.nm, last.nm) - at.nm);
        if (beyond > std::max(furthest, 2.0 * at.error_nm)) {
            furthest = beyond;
            between = &at;
        }
    }
    const auto text = [](const AtSpeed& at) {
        return fmt::format("{:.2g} Nm at {:.3g} deg/s", at.nm, at.speed_deg_s);
    };
    return fmt::format("{} with speed{}: {}{} to {}",
                       between != nullptr || !trend ? "changes"
                       : last.nm > first.nm         ? "grows"
                                                    : "falls",
                       where, text(first), between != nullptr ? ", " + text(*between) : "", text(last));
}

std::string_view direction_name(int direction) { return direction < 0 ? "backward" : "forward"; }

class ChangeTest {
  public:
    explicit ChangeTest(std::span<const RippleAtSpeed> rows)
        : values_(values_of(rows)),
          trend_(trend_of(values_)),
          pairs_(pairs_of(values_)),
          difference_(difference_of(pairs_)) {
        for (const int direction : {1, -1}) {
            std::vector<Value> one;
            for (const Value& value : values_)
                if (value.at->direction == direction) one.push_back(value);
            if (one.size() > 1) by_direction_.push_back(std::move(one));
        }
    }

    [[nodiscard]] AmplitudeChange result() const {
        AmplitudeChange found;
        found.order = values_.front().at->ripple.order;
        if (trend_) found.speed_chance = speed_chance();
        if (difference_) found.direction_chance = difference_->chance();
        found.sentence = fmt::format("order {:.4g}", found.order) + text(found);
        return found;
    }

  private:
    // Each direction is tested by itself, and their common trend: the chance counts as many tries.
    [[nodiscard]] double tries() const { return 1.0 + static_cast<double>(by_direction_.size()); }
    [[nodiscard]] double speed_chance() const {
        double least = trend_->chance();
        for (const auto& one : by_direction_) least = std::min(least, welch_chance(one));
        return std::min(1.0, tries() * least);
    }

    [[nodiscard]] std::string speed_text() const {
        if (tries() * trend_->chance() <= change_false_alarm)
            return course_text(course_of(values_), true, "");
        const auto& one =
            *std::min_element(by_direction_.begin(), by_direction_.end(),
                              [](const auto& a, const auto& b) { return welch_chance(a) < welch_chance(b); });
        const bool both = one.size() < values_.size();
        return course_text(course_of(one), false,
                           both ? fmt::format(" {}", direction_name(one.front().at->direction)) : "");
    }

    [[nodiscard]] std::string direction_text() const {
        double weights = 0.0, forward = 0.0, backward = 0.0;
        for (const Pair& pair : pairs_) {
            weights += pair.weight();
            forward += pair.weight() * pair.forward->nm;
            backward += pair.weight() * pair.backward->nm;
        }
        return fmt::format("differs by direction: {:.2g} Nm forward, {:.2g} Nm backward", forward / weights,
                           backward / weights);
    }

    /// The change that would have been found, as a share of the amplitude: over the range of speed, and
    /// between the directions.
    [[nodiscard]] double speed_bound() const {
        const auto [slow, fast] = std::minmax_element(
            values_.begin(), values_.end(),
            [](const Value& a, const Value& b) { return a.at->speed_deg_s < b.at->speed_deg_s; });
        return share(trend_->detectable(change_false_alarm / tries()) *
                     (fast->at->speed_deg_s - slow->at->speed_deg_s));
    }
    [[nodiscard]] double direction_bound() const {
        return share(difference_->detectable(change_false_alarm));
    }
    [[nodiscard]] double share(double change_nm) const {
        // Of the mean of all alike: weights would prefer the smallest, whose errors are.
        double sum = 0.0;
        for (const Value& one : values_) sum += one.nm;
        return change_nm * static_cast<double>(values_.size()) / sum;
    }

    [[nodiscard]] std::string text(const AmplitudeChange& found) const {
        if (std::none_of(values_.begin(), values_.end(),
                         [](const Value& one) { return one.at->ripple.present(); }))
            return ": no ripple found at any speed";
        const bool by_speed = found.speed_chance && *found.speed_chance <= change_false_alarm;
        const bool by_direction = found.direction_chance && *found.direction_chance <= change_false_alarm;
        std::string changes, none;
        double bound = 0.0;
        if (by_speed) {
            changes = fmt::format(" {} ({})", speed_text(), chance_text(*found.speed_chance));
        } else if (trend_) {
            none = "speed";
            bound = speed_bound();
        }
        if (by_direction) {
            changes += fmt::format("{} {} ({})", changes.empty() ? "" : ";", direction_text(),
                                   chance_text(*found.direction_chance));
        } else if (difference_) {
            none += none.empty() ? "direction" : " or direction";
            bound = std::max(bound, direction_bound());
        }
        if (none.empty() && changes.empty())
            return ": one range of speed in one direction, so no change was tested";
        if (none.empty()) return changes;
        // Two digits.
        const double percent = bound < 1.0 ? 100.0 * bound : 10.0 * std::round(10.0 * bound);
        const std::string within =
            bound < 1.0 ? fmt::format("no change with {} found: within {:.2g} %", none, percent)
                        : fmt::format("a change with {} of less than {:.0f} % would not have been found",
                                      none, percent);
        return changes + (changes.empty() ? ": " : "; ") + within;
    }

    std::vector<Value> values_;
    std::optional<Contrast> trend_;
    std::vector<Pair> pairs_;
    std::optional<Contrast> difference_;
    std::vector<std::vector<Value>> by_direction_;  ///< with more than one speed
};

std::string too_short(Order order, std::size_t segments) {
    return fmt::format(
        "order {:.4g}: too little motion for amplitudes by speed: {} segments of eight motor turns or fewer, "
        "{} in "
        "one direction are needed",
        order.value(), segments, fewest_segments);
}

}  // namespace

AmplitudeBySpeed amplitude_by_speed(std::span<const TraceView> logs, GearRatio ratio,
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
    AmplitudeBySpeed found;
    for (std::size_t i = 0; i < orders.size(); ++i) {
        const std::size_t before = found.ripple.size();
        for (const SpeedBin& bin : bins[i]) {
            for (const int direction : {1, -1}) {
                const OrderSegments& segments = bin[direction < 0 ? 1 : 0];
                if (segments.segments.size() < fewest_segments) continue;
                RippleAtSpeed at{estimate_of(orders[i].value(), segments, tries, least_nm), direction};
                if (!at.ripple.searched()) continue;
                set_speeds(at, segments, bin);
                found.ripple.push_back(std::move(at));
            }
        }
        const std::size_t segments = all.of(orders[i]).segments.size();
        if (found.ripple.size() > before)
            found.changes.push_back(ChangeTest(std::span(found.ripple).subspan(before)).result());
        else if (segments > 0)
            found.changes.push_back({orders[i].value(), {}, {}, too_short(orders[i], segments)});
    }
    return found;
}

}  // namespace ripplenotch
