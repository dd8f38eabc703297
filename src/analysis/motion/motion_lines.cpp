// SPDX-License-Identifier: MIT
#include "analysis/motion/motion_search.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

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

/// The lowest order that is above half the sample rate all the time.
double half_rate_order(std::span<const Sweep> sweeps) {
    double order = 0.0;
    for (const Sweep& sweep : sweeps) {
        if (!sweep.rest()) order = std::max(order, 180.0 * sweep.rate_hz / std::max(sweep.slow_deg_s, 1e-9));
    }
    return order;
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
        const double place = static_cast<double>(candidate.peak.bin) * stack.spacing;
        const bool folded = stack.axis == Axis::angle && place > half_rate_order(sweeps);
        if (folded && !shown_throughout(sweeps, stack, place)) continue;
        if (recurs(sweeps, stack, place)) return candidate;
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

/// The order at half the sample rate in the sweeps that know most: the lower median over their weights, at
/// the upper quartile of their speeds.
double half_rate_of_most(std::span<const Sweep> sweeps, const Stack& stack) {
    std::vector<std::pair<double, double>> orders;
    double total = 0.0, below = 0.0;
    for (std::size_t i = 0; i < sweeps.size(); ++i) {
        if (sweeps[i].rest()) continue;
        orders.emplace_back(180.0 * sweeps[i].rate_hz / std::max(sweeps[i].quick_deg_s, 1e-9),
                            stack.sweep_weights[i]);
        total += stack.sweep_weights[i];
    }
    std::sort(orders.begin(), orders.end());
    for (const auto& [order, weight] : orders) {
        below += weight;
        if (below >= 0.5 * total) return order;
    }
    return 0.0;
}

/// The orders at which a line would have been found, and the largest amplitude that it needs there, to be
/// found in 95 of 100 logs: it has to be significant, and to recur. Bins near found lines are theirs.
std::optional<SearchedOrders> searched_orders(std::span<const Sweep> sweeps, const Stack& stack,
                                              double false_alarm, std::span<const double> taken) {
    constexpr double step = 1.1;  // by hand: the floor varies slowly along the orders
    const PowerSpectrum spectrum = stack.tested();
    const std::vector<double> floor = noise_floor(spectrum);
    const double chance = false_alarm / stack.tries_factor, highest = half_rate_of_most(sweeps, stack);
    SearchedOrders searched;
    for (std::size_t k = std::max<std::size_t>(stack.searched, 1); k < stack.ratio.size();
         k = std::max(k + 1, static_cast<std::size_t>(step * static_cast<double>(k)))) {
        const double place = static_cast<double>(k) * stack.spacing;
        if (place > highest) break;
        if (near_any(taken, place, line_cells * stack.resolution)) continue;
        const double threshold = significant_power(spectrum, floor, k, chance);
        if (!std::isfinite(threshold)) {
            if (searched.detectable_nm > 0.0) break;
            continue;
        }
        const double ratio = std::max(detectable_ratio({.ratio = threshold, .averages = stack.averages[k]}),
                                      recurring_ratio(sweeps, stack, place));
        if (!std::isfinite(ratio)) continue;
        if (!(searched.detectable_nm > 0.0)) searched.lowest_order = place;
        searched.highest_order = place;
        const double here_nm = stack.floor_nm[k] * std::sqrt(ratio);
        searched.detectable_nm = std::max(searched.detectable_nm, here_nm);
        for (auto& bound : searched.bounds) bound.detectable_nm = std::max(bound.detectable_nm, here_nm);
        searched.bounds.push_back({place, here_nm});
    }
    // Of the bounds from each order on those that say less than half of the one before.
    std::vector<SearchedOrders::Bound> steps;
    for (const auto& bound : searched.bounds) {
        if (steps.empty() || bound.detectable_nm < 0.5 * steps.back().detectable_nm) steps.push_back(bound);
    }
    searched.bounds = std::move(steps);
    if (!(searched.detectable_nm > 0.0)) return std::nullopt;
    return searched;
}

struct SpeedRange {
    double slow = 0.0, fast = 0.0;
};

SpeedRange speed_range(std::span<const Sweep> sweeps) {
    SpeedRange range{1e300, 0.0};
    for (const Sweep& sweep : sweeps) {
        if (sweep.rest()) continue;
        range.slow = std::min(range.slow, sweep.slow_deg_s);
        range.fast = std::max(range.fast, sweep.fast_deg_s);
    }
    return range.fast > 0.0 ? range : SpeedRange{};
}

/// Output order of a frequency at the mean speed of the heaviest sweep.
double order_at(std::span<const Sweep> sweeps, const Stack& stack, double hz) {
    const auto heaviest = std::max_element(stack.sweep_weights.begin(), stack.sweep_weights.end());
    if (heaviest == stack.sweep_weights.end()) return 0.0;
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
    // The noise floors on both axes are estimates of their own, in each sweep.
    const auto [apart, error] =
        gain_difference(sweeps, {angle, rivals.has_order ? std::optional(rivals.order) : std::nullopt},
                        {time, rivals.has_hz ? std::optional(rivals.hz) : std::nullopt}, floor_doubt);
    const double decisive = std::max(decisive_nats, error);
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
        if (range.fast > 0.0)
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
    if (sought.line.kind == LineKind::tone && !at_two_speeds(sweeps, stacks.time, rivals.hz))
        sought.line.kind = LineKind::unknown;
    return sought;
}

// What else the domains tell of a line that stays.
void complete(const std::vector<Sweep>& sweeps, const Stacks& stacks, const Rivals& rivals, bool as_order,
              const MotionLinesOptions& options, MotionLine& line) {
    if (line.kind == LineKind::unknown && as_order) {
        line.hz = rivals.hz;
        line.hz_stderr = stacks.time.resolution;
    }
    if (stacks.angle.ratio.empty()) return;  // at standstill
    line.order_seen = rivals.has_order ? rivals.order : order_at(sweeps, stacks.angle, rivals.hz);
    line.folds =
        folds_of(sweeps, stacks.angle, {.seen = line.order_seen, .highest = options.stack.highest_order});
}

/// The search under way: sweeps without what has been found, their spectra, and what is not looked at again.
class LineSearch {
  public:
    LineSearch(std::vector<Sweep>& sweeps, std::span<const TraceView> logs, bool absolute_angle,
               const MotionLinesOptions& options)
        : sweeps_(sweeps),
          options_(options),
          absolute_angle_(absolute_angle),
          range_(speed_range(sweeps)),
          least_amplitude_(least_amplitude_nm(logs, options.least_share)),
          stacks_(stacked(sweeps, options)) {}

    /// One more line; false when there is none.
    bool next() {
        if (auto sought = seek(sweeps_, stacks_, range_, taken_orders_, taken_hz_, options_)) {
            consider(std::move(*sought));
            return true;
        }
        return confirm_prominent();
    }

    std::vector<MotionLine> lines;

    [[nodiscard]] Stacks& stacks() { return stacks_; }
    [[nodiscard]] const SpeedRange& range() const { return range_; }
    [[nodiscard]] const std::vector<double>& taken_orders() const { return taken_orders_; }
    [[nodiscard]] double least_amplitude() const { return least_amplitude_; }

  private:
    /// A line that was taken out of the sweeps before it is known to be one.
    struct Tentative {
        MotionLine line;
        KnownLine known;
        std::size_t bin = 0;
        double ratio = 0.0, floor_nm = 0.0;  ///< of the bin, before it was taken out
        bool confirmed = false;
    };

    [[nodiscard]] const Stack& stack_of(Axis axis) const {
        return axis == Axis::angle ? stacks_.angle : stacks_.time;
    }

    /// Measures what was found and marks its place; empty where it is no line to be reported.
    std::optional<Tentative> measured(Sought sought) {
        MotionLine& line = sought.line;
        const Rivals& rivals = sought.rivals;
        const bool as_order =
            line.kind == LineKind::order || (line.kind == LineKind::unknown && rivals.has_order);
        const Stack& stack = as_order ? stacks_.angle : stacks_.time;
        auto& taken = as_order ? taken_orders_ : taken_hz_;
        const double place = as_order ? rivals.order : rivals.hz;
        // What a line leaves beside itself, because its amplitude changes within a sweep, is no line.
        const bool rest_of_known = near_any(taken, place, line_cells * stack.resolution);
        measure(sweeps_, stack, place, line);
        if (!absolute_angle_) line.phase_deg.reset();
        (sought.by_angle ? taken_orders_ : taken_hz_).push_back(sought.seen_at);
        const bool of_the_motion = !as_order && place < options_.lowest_tone_hz;
        if (rest_of_known || of_the_motion || line.amplitude_nm < least_amplitude_) return std::nullopt;
        taken.push_back(place);
        complete(sweeps_, stacks_, rivals, as_order, options_, line);
        const auto bin =
            std::min(static_cast<std::size_t>(std::lround(place / stack.spacing)), stack.ratio.size() - 1);
        return Tentative{std::move(line),  {stack.axis, place}, bin,
                         stack.ratio[bin], stack.floor_nm[bin], false};
    }

    bool consider(Sought sought) {
        auto one = measured(std::move(sought));
        if (!one) return false;
        take_out(one->known);
        lines.push_back(std::move(one->line));
        return true;
    }

    void take_out(const KnownLine& line) {
        out_.push_back(line);
        take_out_last(sweeps_, out_);
        stacks_ = stacked(sweeps_, options_);
    }

    /// Lines near each other, or near the low end, hide in what each adds to the noise measured beside the
    /// other. A few that are prominent are taken out one after the other; those stay that are significant
    /// above what remains when all of them are out.
    bool confirm_prominent() {
        constexpr std::size_t most_tentative = 3;  // by hand: each costs a further look at all sweeps
        if (!use_prominent_peaks()) return false;
        const State before{torques_of(sweeps_), stacks_, taken_orders_, taken_hz_, out_};
        std::vector<Tentative> tentative;
        for (std::size_t looks = 0; looks < 2 * most_tentative && tentative.size() < most_tentative;
             ++looks) {
            if (!tentative.empty() && !use_prominent_peaks()) break;
            auto sought = seek(sweeps_, stacks_, range_, taken_orders_, taken_hz_, options_);
            if (!sought) break;
            auto one = measured(std::move(*sought));
            if (!one) continue;
            take_out(one->known);
            tentative.push_back(std::move(*one));
            std::size_t confirmed = 0;
            for (Tentative& each : tentative) {
                each.confirmed = is_significant(each);
                confirmed += each.confirmed ? 1 : 0;
            }
            if (confirmed == 0) continue;
            for (Tentative& each : tentative)
                if (each.confirmed) lines.push_back(std::move(each.line));
            if (confirmed == tentative.size()) return true;
            out_ = before.out;
            for (const Tentative& each : tentative)
                if (each.confirmed) out_.push_back(each.known);
            for (Sweep& sweep : sweeps_) fit_out(sweep, out_);
            stacks_ = stacked(sweeps_, options_);
            return true;
        }
        restore(before);
        return false;
    }

    struct State {
        std::vector<std::vector<double>> torque_nm;  ///< by sweep
        Stacks stacks;
        std::vector<double> taken_orders, taken_hz;
        std::vector<KnownLine> out;
    };

    static std::vector<std::vector<double>> torques_of(std::span<const Sweep> sweeps) {
        std::vector<std::vector<double>> torques;
        for (const Sweep& sweep : sweeps) torques.push_back(sweep.torque_nm);
        return torques;
    }

    void restore(const State& before) {
        for (std::size_t i = 0; i < sweeps_.size(); ++i) {
            Sweep& sweep = sweeps_[i];
            sweep.torque_nm = before.torque_nm[i];
            for (std::size_t k = 0; k < sweep.value.size(); ++k)
                sweep.value[k] = sweep.torque_nm[k] * sweep.weight[k];
        }
        stacks_ = before.stacks;
        taken_orders_ = before.taken_orders;
        taken_hz_ = before.taken_hz;
        out_ = before.out;
    }

    /// Candidates in place of significant peaks; false where there is none.
    bool use_prominent_peaks() {
        bool any = false;
        for (const auto& [stack, peaks, lowest, taken] :
             {std::tuple{&stacks_.angle, &stacks_.angle_peaks, 0.0, &taken_orders_},
              std::tuple{&stacks_.time, &stacks_.time_peaks, options_.lowest_tone_hz, &taken_hz_}}) {
            const PowerSpectrum spectrum = stack->tested();
            *peaks = prominent_peaks(spectrum, noise_floor(spectrum), 0.5 * options_.false_alarm);
            for (const SignificantPeak& peak : *peaks) {
                const double place = static_cast<double>(peak.bin) * stack->spacing;
                any = any || (place >= lowest && !near_any(*taken, place, line_cells * stack->resolution));
            }
        }
        return any;
    }

    [[nodiscard]] bool is_significant(const Tentative& one) const {
        const Stack& stack = stack_of(one.known.axis);
        if (one.bin >= stack.ratio.size() || !(stack.floor_nm[one.bin] > 0.0)) return false;
        const PowerSpectrum spectrum = stack.tested();
        const double grown = one.floor_nm / stack.floor_nm[one.bin];
        return one.ratio * grown * grown > significant_power(spectrum, noise_floor(spectrum), one.bin,
                                                             0.5 * options_.false_alarm / stack.tries_factor);
    }

    std::vector<Sweep>& sweeps_;
    const MotionLinesOptions& options_;
    bool absolute_angle_;
    SpeedRange range_;
    double least_amplitude_;
    Stacks stacks_;
    std::vector<double> taken_orders_, taken_hz_;
    std::vector<KnownLine> out_;
};

}  // namespace

MotionSearch search_sweeps(Sweeps cut, std::span<const TraceView> logs, const MotionLinesOptions& options) {
    MotionSearch search;
    MotionLines& found = search.found;
    std::vector<Sweep>& sweeps = cut.pieces;
    for (const Sweep& sweep : sweeps) (sweep.rest() ? found.rests : found.sweeps) += 1;
    found.sweeps_left_out = cut.pieces_left_out;
    found.absolute_angle = cut.absolute_angle;
    if (sweeps.empty()) return search;
    for (const Sweep& sweep : sweeps) found.turns += sweep.length_turns;
    std::vector<std::vector<double>> values;  // as they were before lines were taken out
    for (const Sweep& sweep : sweeps) {
        if (!cut.absolute_angle) values.push_back(sweep.value);
    }
    LineSearch lines(sweeps, logs, cut.absolute_angle, options);
    found.slowest_deg_s = lines.range().slow;
    found.fastest_deg_s = lines.range().fast;
    for (std::size_t round = 0; round < 2 * options.most_lines && lines.lines.size() < options.most_lines;
         ++round) {
        if (!lines.next()) break;
    }
    const Stack& angle = lines.stacks().angle;
    found.resolution_orders = angle.resolution;
    found.highest_spectrum_order = static_cast<double>(angle.ratio.size()) * angle.spacing;
    found.searched = searched_orders(sweeps, angle, 0.5 * options.false_alarm, lines.taken_orders());
    if (found.searched) {
        found.searched->detectable_nm = std::max(found.searched->detectable_nm, lines.least_amplitude());
        for (auto& bound : found.searched->bounds)
            bound.detectable_nm = std::max(bound.detectable_nm, lines.least_amplitude());
    }
    found.humps =
        lines.stacks().time.humps({.false_alarm = options.false_alarm, .lowest = options.lowest_tone_hz});
    found.lines = std::move(lines.lines);
    search.angle = std::move(lines.stacks().angle);
    for (std::size_t i = 0; i < values.size(); ++i) sweeps[i].value = std::move(values[i]);
    if (!cut.absolute_angle) search.sweeps = std::move(sweeps);
    return search;
}

}  // namespace ripplenotch
