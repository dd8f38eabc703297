// SPDX-License-Identifier: MIT
#include "analysis/motion/motion_search.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/motion/line_evidence.hpp"
#include "analysis/motion/line_removal.hpp"
#include "analysis/motion/stacks.hpp"
#include "analysis/shared_limits.hpp"
#include "core/process/two_cores.hpp"
#include "ripplenotch/core/median.hpp"

namespace ripplenotch {
namespace {

constexpr double kept_share = 0.8;  // by hand: of a gain, left once the other line is out
constexpr double line_cells = 2.0;  // half width of a line's main lobe, in resolutions

struct Candidate {
    SignificantPeak peak;
    double gain = 0.0;
};

bool near_any(std::span<const double> lines, double place, double within) {
    return std::any_of(lines.begin(), lines.end(),
                       [&](double line) { return std::abs(place - line) < within; });
}

/// The significant, recurring peak that explains most, apart from lines already found.
std::optional<Candidate> clearest(std::span<const Sweep> sweeps, const Stack& stack,
                                  std::span<const SignificantPeak> peaks, std::span<const double> taken,
                                  double lowest) {
    std::vector<Candidate> candidates;
    for (const SignificantPeak& peak : peaks) {
        const double place = static_cast<double>(peak.bin) * stack.spacing;
        if (place >= lowest && !near_any(taken, place, line_cells * stack.resolution))
            candidates.push_back({peak, gain_at(stack, peak.bin)});
    }
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.gain > b.gain; });
    for (const Candidate& candidate : candidates) {
        if (recurs(sweeps, stack, static_cast<double>(candidate.peak.bin) * stack.spacing))
            return candidate;
    }
    return std::nullopt;
}

/// The most that any line of the other axis explains where this one could be seen there, from..to on that
/// axis.
Candidate best_place_between(const Stack& stack, double from, double to) {
    Candidate best;
    const auto last = static_cast<std::size_t>(std::max(0.0, to / stack.spacing)) + 2;
    const auto begin = static_cast<std::size_t>(std::max(0.0, from / stack.spacing - 1.0));
    for (std::size_t k = std::max(begin, stack.first); k < std::min(last, stack.ratio.size()); ++k) {
        const double gain = gain_at(stack, k);
        if (gain > best.gain) best = {{k, stack.floor_nm[k], 1.0}, gain};
    }
    return best;
}

/// Smaller lines are not reported: a share of the torque's range, and in any case what rounding makes of a
/// constant.
double least_amplitude_of(std::span<const TraceView> logs, double share) {
    double range = 0.0, largest = 0.0;
    for (const TraceView& log : logs) {
        const auto [low, high] = std::minmax_element(log.torque_nm.begin(), log.torque_nm.end());
        if (low == log.torque_nm.end()) continue;
        range = std::max(range, *high - *low);
        largest = std::max({largest, std::abs(*low), std::abs(*high)});
    }
    return std::max(share * range, 1e-9 * largest);
}

/// The largest amplitude, over the orders searched, that a line needs to be found in 95 of 100 logs: it has to
/// be significant, and to recur. Bins near found lines are theirs.
double detectable(std::span<const Sweep> sweeps, const Stack& stack, double false_alarm,
                  std::span<const double> taken) {
    constexpr std::size_t most_asked = 512;  // by hand: the floor varies slowly along the bins
    const PowerSpectrum spectrum = stack.tested();
    const double chance = false_alarm / stack.tries_factor;
    const std::size_t end = stack.ratio.size(), from = std::min(stack.searched, end);
    const std::size_t stride = std::max<std::size_t>(1, (end - from) / most_asked);
    double largest = 0.0;
    for (std::size_t k = from; k < end; k += stride) {
        if (near_any(taken, static_cast<double>(k) * stack.spacing, line_cells * stack.resolution)) continue;
        const double threshold = significant_power(spectrum, k, chance);
        if (!std::isfinite(threshold)) continue;
        const double ratio = std::max(detectable_ratio(threshold, stack.averages[k]),
                                      recurring_ratio(sweeps, stack, static_cast<double>(k) * stack.spacing));
        largest = std::max(largest, stack.floor_nm[k] * std::sqrt(ratio));
    }
    return largest;
}

struct SpeedRange {
    double slow = 0.0, fast = 0.0;
};

SpeedRange speed_range(std::span<const Sweep> sweeps) {
    SpeedRange range{1e300, 0.0};
    for (const Sweep& sweep : sweeps) {
        range.slow = std::min(range.slow, sweep.slow_deg_s);
        range.fast = std::max(range.fast, sweep.fast_deg_s);
    }
    return range;
}

/// Output order of a frequency at the mean speed of the heaviest sweep.
double order_at(std::span<const Sweep> sweeps, const Stack& stack, double hz) {
    const auto heaviest = std::max_element(stack.sweep_weights.begin(), stack.sweep_weights.end());
    const Sweep& sweep = sweeps[static_cast<std::size_t>(heaviest - stack.sweep_weights.begin())];
    return 360.0 * hz / std::max(std::abs(sweep.mean_deg_s), 1e-9);
}

/// A line of one axis and the most that the other axis offers where the first could be seen there.
struct Rivals {
    double order = 0.0, hz = 0.0;
    bool has_order = false, has_hz = false;
    double gain_angle = 0.0, gain_time = 0.0;
};

/// True when a place is a significant peak itself, not merely the best that noise offers.
bool stands_out(const Stack& stack, std::span<const SignificantPeak> peaks, double place) {
    return std::any_of(peaks.begin(), peaks.end(), [&](const SignificantPeak& peak) {
        return std::abs(static_cast<double>(peak.bin) * stack.spacing - place) < stack.resolution;
    });
}

LineKind judged(const std::vector<Sweep>& sweeps, const Stacks& stacks, const Rivals& rivals, bool by_angle) {
    const auto& [angle, time, angle_peaks, time_peaks] = stacks;
    const double apart = rivals.gain_angle - rivals.gain_time;
    // The two noise floors are estimates of their own, a few per cent apart.
    const double decisive =
        std::max(decisive_nats, floor_doubt * std::max(rivals.gain_angle, rivals.gain_time));
    if (std::abs(apart) > decisive) return apart > 0.0 ? LineKind::order : LineKind::tone;
    const bool two_lines =
        rivals.has_order && rivals.has_hz &&
        (by_angle ? stands_out(time, time_peaks, rivals.hz) : stands_out(angle, angle_peaks, rivals.order));
    if (!two_lines) return LineKind::unknown;
    // Two lines, not one seen twice, when each keeps what it explains after the other is taken out.
    const double order_left = gain_without(sweeps, {Axis::time, rivals.hz}, angle, rivals.order);
    const double tone_left = gain_without(sweeps, {Axis::angle, rivals.order}, time, rivals.hz);
    if (order_left < kept_share * rivals.gain_angle || tone_left < kept_share * rivals.gain_time)
        return LineKind::unknown;
    return by_angle ? LineKind::order : LineKind::tone;
}

// One line looked for: where it stands in both domains, as far as it stands there.
struct Sought {
    MotionLine line;
    Rivals rivals;
    bool by_angle = false;  ///< the domain in which it was seen first
    double seen_at = 0.0;   ///< in that domain
};

std::optional<Sought> seek(const std::vector<Sweep>& sweeps, const Stacks& stacks, const SpeedRange& range,
                           const std::vector<double>& taken_orders, const std::vector<double>& taken_hz,
                           const MotionLinesOptions& options) {
    const Stack &angle = stacks.angle, &time = stacks.time;
    std::optional<Candidate> order, tone;
    on_two_cores(2, [&](std::size_t i) {
        if (i == 0)
            order = clearest(sweeps, angle, stacks.angle_peaks, taken_orders, 0.0);
        else
            tone = clearest(sweeps, time, stacks.time_peaks, taken_hz, options.lowest_tone_hz);
    });
    if (!order && !tone) return std::nullopt;
    Sought sought;
    sought.by_angle = order && (!tone || order->gain >= tone->gain);
    std::size_t order_bin = 0, hz_bin = 0;
    if (sought.by_angle) {
        order_bin = order->peak.bin;
        sought.seen_at = static_cast<double>(order_bin) * angle.spacing;
        hz_bin =
            best_place_between(time, sought.seen_at * range.slow / 360.0, sought.seen_at * range.fast / 360.0)
                .peak.bin;
        sought.line.false_alarm = order->peak.false_alarm;
    } else {
        hz_bin = tone->peak.bin;
        sought.seen_at = static_cast<double>(hz_bin) * time.spacing;
        order_bin = best_place_between(angle, sought.seen_at * 360.0 / range.fast,
                                       sought.seen_at * 360.0 / range.slow)
                        .peak.bin;
        sought.line.false_alarm = tone->peak.false_alarm;
    }
    Rivals& rivals = sought.rivals;
    rivals.has_order = order_bin > 0;
    rivals.has_hz = hz_bin > 0;
    if (rivals.has_order) rivals.order = refined(sweeps, angle, order_bin);
    if (rivals.has_hz) rivals.hz = refined(sweeps, time, hz_bin);
    rivals.gain_angle = rivals.has_order ? gain_of(sweeps, angle, rivals.order) : 0.0;
    rivals.gain_time = rivals.has_hz ? gain_of(sweeps, time, rivals.hz) : 0.0;
    sought.line.gain_angle = rivals.gain_angle;
    sought.line.gain_time = rivals.gain_time;
    sought.line.kind = judged(sweeps, stacks, rivals, sought.by_angle);
    return sought;
}

// What else the domains tell of a line that stays.
void complete(const std::vector<Sweep>& sweeps, const Stacks& stacks, const Rivals& rivals, bool as_order,
              const MotionLinesOptions& options, MotionLine& line) {
    if (line.kind == LineKind::unknown && as_order) {
        line.hz = rivals.hz;
        line.hz_stderr = stacks.time.resolution;
    }
    line.order_seen = rivals.has_order ? rivals.order : order_at(sweeps, stacks.angle, rivals.hz);
    line.folds =
        folds_of(sweeps, stacks.angle, {.seen = line.order_seen, .highest = options.stack.highest_order});
}

/// What was searched, and what would have been found there; nothing where no order was.
void state_search(std::span<const Sweep> sweeps, const Stack& angle, double least_amplitude,
                  double false_alarm, std::span<const double> taken, MotionLines& found) {
    found.resolution_orders = angle.resolution;
    const double detectable_nm = detectable(sweeps, angle, 0.5 * false_alarm, taken);
    if (!(detectable_nm > 0.0)) return;
    found.detectable_nm = std::max(least_amplitude, detectable_nm);
    found.lowest_order = static_cast<double>(angle.searched) * angle.spacing;
    found.highest_order = static_cast<double>(angle.ratio.size()) * angle.spacing;
}

}  // namespace

MotionSearch search_sweeps(Sweeps cut, std::span<const TraceView> logs, const MotionLinesOptions& options) {
    MotionSearch search;
    MotionLines& found = search.found;
    std::vector<Sweep>& sweeps = cut.pieces;
    found.sweeps = sweeps.size();
    found.sweeps_left_out = cut.pieces_left_out;
    found.absolute_angle = cut.absolute_angle;
    if (sweeps.empty()) return search;
    const SpeedRange range = speed_range(sweeps);
    found.slowest_deg_s = range.slow;
    found.fastest_deg_s = range.fast;
    for (const Sweep& sweep : sweeps) found.turns += sweep.length_turns;

    std::vector<double> taken_orders, taken_hz = options.known_hz;
    std::vector<KnownLine> out;
    const auto take_out = [&](Axis axis, double place) {
        out.push_back({axis, place});
        take_out_last(sweeps, out);
    };
    for (const double hz : options.known_hz) take_out(Axis::time, hz);
    std::vector<std::vector<double>> values;  // as they were before lines were taken out
    for (const Sweep& sweep : sweeps) {
        if (!cut.absolute_angle) values.push_back(sweep.value);
    }
    const double least_amplitude = least_amplitude_of(logs, options.least_share);
    Stacks stacks = stacked(sweeps, options);
    for (std::size_t round = 0; round < 2 * options.most_lines && found.lines.size() < options.most_lines;
         ++round) {
        auto sought = seek(sweeps, stacks, range, taken_orders, taken_hz, options);
        if (!sought) break;
        MotionLine& line = sought->line;
        const Rivals& rivals = sought->rivals;
        const bool as_order =
            line.kind == LineKind::order || (line.kind == LineKind::unknown && rivals.has_order);
        const Stack& stack = as_order ? stacks.angle : stacks.time;
        auto& taken = as_order ? taken_orders : taken_hz;
        const double place = as_order ? rivals.order : rivals.hz;
        // What a line leaves beside itself, because its amplitude changes within a sweep, is no line.
        const bool rest_of_known = near_any(taken, place, line_cells * stack.resolution);
        measure(sweeps, stack, place, line);
        if (!cut.absolute_angle) line.phase_deg.reset();
        (sought->by_angle ? taken_orders : taken_hz).push_back(sought->seen_at);
        const bool of_the_motion = !as_order && place < options.lowest_tone_hz;
        if (rest_of_known || of_the_motion || line.amplitude_nm < least_amplitude) continue;
        taken.push_back(place);
        complete(sweeps, stacks, rivals, as_order, options, line);
        take_out(stack.axis, place);
        found.lines.push_back(std::move(line));
        if (found.lines.size() < options.most_lines) stacks = stacked(sweeps, options);
    }
    state_search(sweeps, stacks.angle, least_amplitude, options.false_alarm, taken_orders, found);
    found.humps = stacks.time.humps({.false_alarm = options.false_alarm, .lowest = options.lowest_tone_hz});
    search.angle = std::move(stacks.angle);
    for (std::size_t i = 0; i < values.size(); ++i) sweeps[i].value = std::move(values[i]);
    if (!cut.absolute_angle) search.sweeps = std::move(sweeps);
    return search;
}

}  // namespace ripplenotch
