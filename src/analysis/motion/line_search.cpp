// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/line_search.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>

#include "analysis/motion/line_evidence.hpp"
#include "analysis/motion/sweep_fit.hpp"
#include "analysis/motion/velocity_error.hpp"
#include "analysis/shared_limits.hpp"
#include "core/process/two_cores.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

namespace {

// Chosen, not derived: share of an improvement that remains once the other line is removed.
constexpr double kept_share = 0.8;
constexpr double line_cells = 2.0;  // half width of a line's main lobe, in resolutions

/// The sweeps on both axes, without the lines that were removed from them.
struct Stacks {
    Stack angle, time;
};

Stacks stacked(std::span<const Sweep> sweeps, const MotionLinesOptions& options) {
    return {stack_sweeps(sweeps, Axis::angle, options.stack),
            stack_sweeps(sweeps, Axis::time, options.stack)};
}

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

/// The prominent peak that explains most, apart from lines already found.
std::optional<Candidate> clearest(std::span<const Sweep> sweeps, const Stack& stack, double false_alarm,
                                  std::span<const double> taken, double lowest) {
    const PowerSpectrum spectrum = stack.tested();
    std::optional<Candidate> best;
    for (const SignificantPeak& peak : prominent_peaks(spectrum, noise_floor(spectrum), false_alarm)) {
        const double place = static_cast<double>(peak.bin) * stack.spacing;
        if (place < lowest || near_any(taken, place, line_cells * stack.resolution)) continue;
        const double gain = gain_at(stack, peak.bin);
        if (best && gain <= best->gain) continue;
        const bool folded = stack.axis == Axis::angle && place > half_rate_order(sweeps);
        if (!folded || shown_throughout(sweeps, stack, place)) best = Candidate{peak, gain};
    }
    return best;
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

/// The order at half the sample rate in the most informative sweeps: the lower median over their weights, at
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
                                              double false_alarm, std::span<const double> taken,
                                              std::span<const SearchedOrders::Bound> unreported) {
    constexpr double step = 1.1;  // chosen, not derived: the floor varies slowly along the orders
    const PowerSpectrum spectrum = stack.tested();
    const std::vector<double> floor = noise_floor(spectrum);
    const double chance = false_alarm / stack.tries_factor, highest = half_rate_of_most(sweeps, stack);
    SearchedOrders searched;
    for (std::size_t k = std::max<std::size_t>(stack.searched, 1); k < stack.ratio.size();
         k = std::max(k + 1, static_cast<std::size_t>(step * static_cast<double>(k)))) {
        const double place = static_cast<double>(k) * stack.spacing;
        if (place < stack.lowest) continue;
        if (place > highest) break;
        if (near_any(taken, place, line_cells * stack.resolution)) continue;
        const double threshold = line_threshold(spectrum, floor, k, chance).line;
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
    for (const auto& [order, amplitude_nm] : unreported) {
        if (order < searched.lowest_order || order > searched.highest_order) continue;
        searched.detectable_nm = std::max(searched.detectable_nm, amplitude_nm);
        for (auto& bound : searched.bounds)
            if (bound.from_order <= order) bound.detectable_nm = std::max(bound.detectable_nm, amplitude_nm);
    }
    // Keeps each bound that is less than half of the one before.
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
    bool two_lines = false;  ///< both are prominent, the one that was not seen first as well
};

/// Order or tone, by what explains the line more; unknown where neither does. `two_lines`: at the line's
/// frequencies there is a line of the other axis as well.
LineKind judged(std::span<const Sweep> sweeps, const Stacks& stacks, const Rivals& rivals, bool by_angle) {
    const Stack &angle = stacks.angle, &time = stacks.time;
    const auto [apart, error] =
        gain_difference(sweeps, {angle, rivals.has_order ? std::optional(rivals.order) : std::nullopt},
                        {time, rivals.has_hz ? std::optional(rivals.hz) : std::nullopt});
    const double decisive = std::max(decisive_nats, error);
    if (std::abs(apart) > decisive) return apart > 0.0 ? LineKind::order : LineKind::tone;
    if (!rivals.two_lines) return LineKind::unknown;
    // Two lines, not one seen twice, when the improvement by each remains after the other is removed.
    const double order_left = gain_without(sweeps, {Axis::time, rivals.hz}, angle, rivals.order);
    const double tone_left = gain_without(sweeps, {Axis::angle, rivals.order}, time, rivals.hz);
    if (order_left < kept_share * gain_of(sweeps, angle, rivals.order) ||
        tone_left < kept_share * gain_of(sweeps, time, rivals.hz))
        return LineKind::unknown;
    return by_angle ? LineKind::order : LineKind::tone;
}

/// A line that was removed from the sweeps before it is known to be one.
struct CandidateLine {
    KnownLine known;
    Rivals rivals;
    bool by_angle = false;              ///< the axis on which it was seen first
    LineKind kind = LineKind::unknown;  ///< when it was seen
};

/// Lines hide each other: each adds to the noise that is measured near the others. So whatever is prominent
/// is removed, the clearest first, and then each candidate is tested against the noise that remains when all
/// of them are removed. Candidates that fail are put back, which raises the noise for the others; what
/// remains in
/// the end is significant each by itself.
class LineSearch {
  public:
    LineSearch(std::vector<Sweep>& sweeps, std::span<const TraceView> logs, bool absolute_angle,
               const MotionLinesOptions& options)
        : sweeps_(sweeps),
          options_(options),
          absolute_angle_(absolute_angle),
          range_(speed_range(sweeps)),
          least_amplitude_(least_amplitude_nm(logs, options.least_share)),
          stacks_(stacked(sweeps, options)) {
        std::size_t looks = 0;
        bool put_back = true;
        // What was put back may have stood for another: the image of an order for the order itself.
        while (put_back) {
            while (looks < 2 * options.most_lines && out_.size() < options.most_lines && remove_clearest())
                ++looks;
            put_back = false;
            while (put_back_insignificant()) put_back = true;
        }
    }

    /// The clearest first. A line that does not recur is none: a burst, or the ripple of another joint that
    /// passes by. Near the low end a maximum that is no noise may still be motion. Both stay removed, and are
    /// not reported.
    [[nodiscard]] std::vector<MotionLine> lines() {
        std::vector<MotionLine> lines;
        for (std::size_t i = 0; i < out_.size(); ++i) {
            const std::vector<Sweep> sweeps = with_line(sweeps_, out_, i);
            const auto& [axis, place] = out_[i];
            MotionLine line = measured(sweeps, i);
            const bool is_line = shares_of_threshold(sweeps, i).line > 1.0;
            if (!is_line || !recurs(sweeps, stack_of(axis), place)) {
                const double order = axis == Axis::angle ? place : line.order_seen;
                double largest_nm = 0.0;
                for (const AmplitudeAtSpeed& seen : line.by_speed)
                    largest_nm = std::max(largest_nm, seen.amplitude_nm);
                unreported_.push_back({order, largest_nm});
                if (is_line) once_nm_ = std::max(once_nm_, largest_nm);
                continue;
            }
            if (line.amplitude_nm < least_amplitude_) continue;
            if (axis == Axis::angle) orders_.push_back(place);
            lines.push_back(std::move(line));
        }
        return lines;
    }
    /// The orders among the lines that lines() returned.
    [[nodiscard]] std::span<const double> orders() const { return orders_; }
    /// Lines that lines() left out, by order: nothing smaller is claimed to be absent there.
    [[nodiscard]] std::span<const SearchedOrders::Bound> unreported() const { return unreported_; }

    /// The largest of lines that lines() left out because only one sweep shows it.
    [[nodiscard]] double once_nm() const { return once_nm_; }

    [[nodiscard]] Stacks& stacks() { return stacks_; }
    [[nodiscard]] const SpeedRange& range() const { return range_; }
    [[nodiscard]] double least_amplitude() const { return least_amplitude_; }

  private:
    [[nodiscard]] const Stack& stack_of(Axis axis) const {
        return axis == Axis::angle ? stacks_.angle : stacks_.time;
    }
    [[nodiscard]] double false_alarm() const { return 0.5 * options_.false_alarm; }  // two axes are searched
    [[nodiscard]] double lowest_tone_hz() const {
        return range_.fast > 0.0 ? options_.lowest_tone_hz : options_.lowest_tone_at_rest_hz;
    }

    /// False when nothing is prominent.
    bool remove_clearest() {
        const Stack &angle = stacks_.angle, &time = stacks_.time;
        std::optional<Candidate> order, tone;
        on_two_cores(2, [&](std::size_t i) {
            if (i == 0)
                order = clearest(sweeps_, angle, false_alarm(), taken_orders_, 0.0);
            else
                tone = clearest(sweeps_, time, false_alarm(), taken_hz_, lowest_tone_hz());
        });
        if (!order && !tone) return false;
        CandidateLine line;
        line.by_angle = order && (!tone || order->gain >= tone->gain);
        line.rivals = rivals_of(line.by_angle ? order->peak.bin : tone->peak.bin, line.by_angle);
        line.kind = judged(sweeps_, stacks_, line.rivals, line.by_angle);
        // Slow tones are not looked for, since the motion makes them: what is seen over the angle is an order
        // or such a tone. Of two tones at two speeds an order may explain half of each: what is seen at both
        // speeds is a tone.
        const bool slow = line.rivals.hz < lowest_tone_hz();
        if (slow && line.kind == LineKind::tone) line.kind = LineKind::unknown;
        const bool as_tone = line.kind == LineKind::tone || (line.kind == LineKind::unknown && !slow &&
                                                             at_two_speeds(sweeps_, time, line.rivals.hz) &&
                                                             recurs(sweeps_, time, line.rivals.hz));
        const bool as_order = line.rivals.has_order && !as_tone;
        const Stack& stack = as_order ? angle : time;
        auto& taken = as_order ? taken_orders_ : taken_hz_;
        line.known = {stack.axis, as_order ? line.rivals.order : line.rivals.hz};
        // The residual of a line near itself, because its amplitude changes within a sweep, is no line.
        const bool rest_of_known = near_any(taken, line.known.place, line_cells * stack.resolution);
        const std::size_t seen_bin = line.by_angle ? order->peak.bin : tone->peak.bin;
        (line.by_angle ? taken_orders_ : taken_hz_)
            .push_back(static_cast<double>(seen_bin) * (line.by_angle ? angle : time).spacing);
        if (rest_of_known) return true;
        taken.push_back(line.known.place);
        candidates_.push_back(line);
        out_.push_back(line.known);
        remove_last(sweeps_, out_);
        stack_again();
        return true;
    }

    void stack_again() {
        stacks_ = stacked(sweeps_, options_);
        for (const KnownLine& line : out_)
            (line.axis == Axis::angle ? stacks_.angle : stacks_.time).mark_removed(line.place);
    }

    /// Where a peak stands on its own axis, and the most that the other axis offers for it.
    [[nodiscard]] Rivals rivals_of(std::size_t bin, bool by_angle) const {
        const Stack &angle = stacks_.angle, &time = stacks_.time;
        const double seen_at = static_cast<double>(bin) * (by_angle ? angle : time).spacing;
        Candidate other;
        if (by_angle)
            other = best_place_between(time, seen_at * range_.slow / 360.0, seen_at * range_.fast / 360.0);
        else if (range_.fast > 0.0)
            other = best_place_between(angle, seen_at * 360.0 / range_.fast, seen_at * 360.0 / range_.slow);
        const std::size_t order_bin = by_angle ? bin : other.peak.bin;
        const std::size_t hz_bin = by_angle ? other.peak.bin : bin;
        Rivals rivals;
        rivals.has_order = order_bin > 0;
        rivals.has_hz = hz_bin > 0;
        if (rivals.has_order) rivals.order = refined(sweeps_, angle, order_bin);
        if (rivals.has_hz) rivals.hz = refined(sweeps_, time, hz_bin);
        if (rivals.has_order && rivals.has_hz) {
            const Stack& stack = by_angle ? time : angle;
            const double place = by_angle ? rivals.hz : rivals.order;
            const PowerSpectrum spectrum = stack.tested();
            for (const SignificantPeak& peak :
                 prominent_peaks(spectrum, noise_floor(spectrum), false_alarm()))
                rivals.two_lines =
                    rivals.two_lines ||
                    std::abs(static_cast<double>(peak.bin) * stack.spacing - place) < stack.resolution;
        }
        return rivals;
    }

    /// Puts back the weakest of the candidates that are not significant, and those with it that are not
    /// collinear with it: of two collinear candidates neither seems to be needed. False when all are
    /// significant.
    bool put_back_insignificant() {
        std::vector<std::pair<double, std::size_t>> failed;
        for (std::size_t i = 0; i < out_.size(); ++i)
            if (const double share = shares_of_threshold(with_line(sweeps_, out_, i), i).noise;
                !(share > 1.0))
                failed.emplace_back(share, i);
        if (failed.empty()) return false;
        std::sort(failed.begin(), failed.end());
        std::vector<std::size_t> dropped;
        for (const auto& [share, i] : failed)
            if (std::all_of(dropped.begin(), dropped.end(),
                            [&](std::size_t other) { return apart(sweeps_, out_[i], out_[other]); }))
                dropped.push_back(i);
        std::sort(dropped.begin(), dropped.end(), std::greater());
        for (const std::size_t i : dropped) {
            out_.erase(out_.begin() + static_cast<std::ptrdiff_t>(i));
            candidates_.erase(candidates_.begin() + static_cast<std::ptrdiff_t>(i));
        }
        on_two_cores(sweeps_.size(), [&](std::size_t i) { fit_out(sweeps_[i], out_); });
        stack_again();
        return true;
    }

    /// The power of a candidate over those from which on it is no noise, and a line, against the noise that
    /// remains when all candidates are removed. `sweeps` hold it alone.
    [[nodiscard]] LineThreshold shares_of_threshold(std::span<const Sweep> sweeps,
                                                    std::size_t candidate) const {
        const auto& [axis, place] = out_[candidate];
        const Stack& stack = stack_of(axis);
        const auto bin = static_cast<std::size_t>(std::lround(place / stack.spacing));
        if (bin >= stack.ratio.size() || !(stack.averages[bin] > 0.0)) return {};
        const PowerSpectrum spectrum = stack.tested();
        const LineThreshold threshold =
            line_threshold(spectrum, noise_floor(spectrum), bin, false_alarm() / stack.tries_factor);
        const double power = mean_ratio(sweeps, stack, place);
        return {power / threshold.noise, power / threshold.line};
    }

    [[nodiscard]] MotionLine measured(std::span<const Sweep> sweeps, std::size_t candidate) const {
        const auto& [known, rivals, by_angle, kind] = candidates_[candidate];
        const Stack &angle = stacks_.angle, &time = stacks_.time;
        MotionLine line;
        line.gain_angle = rivals.has_order ? gain_of(sweeps, angle, rivals.order) : 0.0;
        line.gain_time = rivals.has_hz ? gain_of(sweeps, time, rivals.hz) : 0.0;
        line.kind = judged(sweeps, stacks_, rivals, by_angle);
        // A removed line may have taken with it what would be evidence for the other axis.
        const KnownLine rival = known.axis == Axis::angle ? KnownLine{Axis::time, rivals.hz}
                                                          : KnownLine{Axis::angle, rivals.order};
        bool contested = false;
        for (std::size_t i = 0; i < out_.size(); ++i)
            contested = contested || (i != candidate && !apart(sweeps, rival, out_[i]));
        // Nor is a line that was open called a tone because it was removed as one.
        if (line.kind != kind && (contested || line.kind == LineKind::tone)) line.kind = LineKind::unknown;
        const bool as_order = known.axis == Axis::angle;
        if (line.kind == (as_order ? LineKind::tone : LineKind::order)) line.kind = LineKind::unknown;
        if (line.kind == LineKind::tone && !at_two_speeds(sweeps, time, rivals.hz))
            line.kind = LineKind::unknown;
        measure(sweeps, stack_of(known.axis), known.place, line);
        if (!absolute_angle_) line.phase_deg.reset();
        if (line.kind == LineKind::unknown && as_order) {
            line.hz = rivals.hz;
            line.hz_stderr = time.resolution;
        }
        if (angle.ratio.empty()) return line;  // at standstill
        line.order_seen = rivals.has_order ? rivals.order : order_at(sweeps, angle, rivals.hz);
        if (line.kind == LineKind::unknown && !as_order) {
            line.order_output = line.order_seen;
            line.order_stderr = angle.resolution;
        }
        line.folds =
            folds_of(sweeps, angle, {.seen = line.order_seen, .highest = options_.stack.highest_order});
        return line;
    }

    std::vector<Sweep>& sweeps_;
    const MotionLinesOptions& options_;
    bool absolute_angle_;
    SpeedRange range_;
    double least_amplitude_;
    Stacks stacks_;
    std::vector<double> taken_orders_, taken_hz_, orders_;
    std::vector<SearchedOrders::Bound> unreported_;
    double once_nm_ = 0.0;
    std::vector<KnownLine> out_;             ///< removed from the sweeps
    std::vector<CandidateLine> candidates_;  ///< the same, with what is known of each
};

/// Standard deviation of what is left of the torque in motion, under the weights of the sweeps.
double deviation_of(std::span<const Sweep> sweeps) {
    double squares = 0.0, weights = 0.0;
    for (const Sweep& sweep : sweeps) {
        if (sweep.rest()) continue;
        for (std::size_t k = 0; k < sweep.torque_nm.size(); ++k)
            squares += sweep.weight[k] * sweep.torque_nm[k] * sweep.torque_nm[k];
        weights += sweep.weight_sum;
    }
    return weights > 0.0 ? std::sqrt(squares / weights) : 0.0;
}

struct MotionSearch {
    MotionLines found;
    Stack angle;                ///< stack of the residual without the lines
    std::vector<Sweep> sweeps;  ///< where the angle is not absolute: no line that was found removed
};

/// Tones slower than those that are distinguished from the motion, where the joint is at rest.
std::vector<MotionLine> slow_tones_at_rest(std::span<const Sweep> sweeps, std::span<const TraceView> logs,
                                           const MotionLinesOptions& options) {
    std::vector<Sweep> rests;
    std::copy_if(sweeps.begin(), sweeps.end(), std::back_inserter(rests),
                 [](const Sweep& sweep) { return sweep.rest(); });
    if (rests.empty() || rests.size() == sweeps.size()) return {};  // or all were searched so
    for (Sweep& rest : rests) fit_out(rest, {});
    std::vector<MotionLine> tones = LineSearch(rests, logs, false, options).lines();
    std::erase_if(tones, [&](const MotionLine& tone) { return tone.hz >= options.lowest_tone_hz; });
    return tones;
}

/// The search for lines in sweeps whose angle is taken as it is.
MotionSearch search_sweeps(Sweeps cut, std::span<const TraceView> logs, const MotionLinesOptions& options) {
    MotionSearch search;
    MotionLines& found = search.found;
    std::vector<Sweep>& sweeps = cut.pieces;
    for (const Sweep& sweep : sweeps) (sweep.rest() ? found.rests : found.sweeps) += 1;
    found.sweeps_left_out = cut.pieces_left_out;
    found.absolute_angle = cut.absolute_angle;
    if (sweeps.empty()) return search;
    for (const Sweep& sweep : sweeps) found.turns += sweep.length_turns;
    std::vector<std::vector<double>> values;  // values before lines were removed
    for (const Sweep& sweep : sweeps) {
        if (!cut.absolute_angle) values.push_back(sweep.value);
    }
    LineSearch search_of(sweeps, logs, cut.absolute_angle, options);
    found.slowest_deg_s = search_of.range().slow;
    found.fastest_deg_s = search_of.range().fast;
    found.lines = search_of.lines();
    for (MotionLine& tone : slow_tones_at_rest(sweeps, logs, options)) found.lines.push_back(std::move(tone));
    const Stack& angle = search_of.stacks().angle;
    found.resolution_orders = angle.resolution;
    found.highest_spectrum_order = static_cast<double>(angle.ratio.size()) * angle.spacing;
    found.searched =
        searched_orders(sweeps, angle, 0.5 * options.false_alarm, search_of.orders(), search_of.unreported());
    if (found.searched) {
        const double least_nm = search_of.least_amplitude();
        found.searched->deviation_nm = std::max(deviation_of(sweeps), least_nm);
        found.searched->detectable_nm = std::max(found.searched->detectable_nm, least_nm);
        for (auto& bound : found.searched->bounds)
            bound.detectable_nm = std::max(bound.detectable_nm, least_nm);
        // A line that one sweep shows leaves the whole range open.
        if (search_of.once_nm() > found.searched->deviation_nm) found.searched->bounds.resize(1);
    }
    search.angle = std::move(search_of.stacks().angle);
    for (std::size_t i = 0; i < values.size(); ++i) sweeps[i].value = std::move(values[i]);
    if (!cut.absolute_angle) search.sweeps = std::move(sweeps);
    return search;
}

// Chosen, not derived: share of a cycle of the highest order. A line moved by less loses less than a
// hundredth of its height.
constexpr double unseen_cycles = 0.02;

/// The orders among the lines, the one that explains most first.
std::vector<MotionLine*> orders_among(std::vector<MotionLine>& lines) {
    std::vector<MotionLine*> orders;
    for (MotionLine& line : lines) {
        if (line.kind == LineKind::order) orders.push_back(&line);
    }
    std::stable_sort(orders.begin(), orders.end(),
                     [](const MotionLine* a, const MotionLine* b) { return a->gain_angle > b->gain_angle; });
    return orders;
}

}  // namespace

MotionLines find_motion_lines(std::span<const TraceView> logs, const MotionLinesOptions& options) {
    MotionSearch search = search_sweeps(cut_sweeps(logs, options.sweeps), logs, options);
    MotionLines& found = search.found;
    if (found.absolute_angle) return std::move(found);
    const std::vector<MotionLine*> lines = orders_among(found.lines);
    std::vector<double> orders;
    for (const MotionLine* line : lines) orders.push_back(line->order_output);
    const auto fit = fit_velocity_error(logs, search.sweeps, search.angle, orders);
    if (!fit) return std::move(found);
    MotionLines again;
    if (fit->most_cycles > unseen_cycles)
        again = search_sweeps(cut_sweeps(logs, options.sweeps, fit->error), logs, options).found;
    if (orders_among(again.lines).empty()) {
        for (std::size_t i = 0; i < fit->order_shares.size(); ++i)
            lines[i]->order_output *= 1.0 + fit->order_shares[i];
        again = std::move(found);
    }
    again.velocity_error = fit->error;
    again.order_share_error = fit->order_share_error;
    return again;
}

}  // namespace ripplenotch
