// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/line_search.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/lines/line_scan.hpp"
#include "analysis/motion/velocity_error.hpp"
#include "ripplenotch/analysis/line_test.hpp"

namespace ripplenotch {

namespace {

/// Difference in log-likelihood (odds of 150 to 1) by which one explanation of a line has to exceed another.
constexpr double decisive_nats = 5.0;  // chosen, not derived

struct SpeedRange {
    double slow = 0.0, fast = 0.0;
    double quick = 0.0;  ///< without the fastest quarter of each sweep
    bool rests = false;
};

SpeedRange speed_range(std::span<const Sweep> sweeps) {
    SpeedRange range{1e300};
    for (const Sweep& sweep : sweeps) {
        range.rests = range.rests || sweep.rest();
        if (sweep.rest()) continue;
        range.quick = std::max(range.quick, sweep.quick_deg_s);
        range.slow = std::min(range.slow, sweep.slow_deg_s);
        range.fast = std::max(range.fast, sweep.fast_deg_s);
    }
    return range.fast > 0.0 ? range : SpeedRange{.rests = range.rests};
}

struct Peak {
    double place = 0.0, evidence = 0.0;
    double top = 0.0;  ///< where the evidence is largest
};

ScanRange orders_of(std::span<const Sweep> sweeps, const MotionLinesOptions& options) {
    // Over two turns and more the load, once and twice a turn, is clear of order 5.
    constexpr double long_turns = 2.0, lowest_of_long = 5.0;
    double longest = 0.0;
    for (const Sweep& sweep : sweeps) longest = std::max(longest, sweep.length_turns);
    const double lowest =
        longest >= long_turns ? std::min(lowest_of_long, options.lowest_order) : options.lowest_order;
    return {lowest, options.highest_order, options.lowest_order, options.highest_folded_order};
}

class LineSearch {
  public:
    LineSearch(std::span<const Sweep> sweeps, std::span<const TraceView> logs,
               const MotionLinesOptions& options)
        : options_(options),
          range_(speed_range(sweeps)),
          least_nm_(least_amplitude_nm(logs, options.least_share)),
          angle_(sweeps, logs, Axis::angle, orders_of(sweeps, options)),
          time_(sweeps, logs, Axis::time, {options.lowest_hz, 1e9, options.lowest_hz}) {
        score();
        while (taken_.size() < options.most_lines && take_clearest()) score();
        if (!angle_.empty()) angle_.measure_scatter();
        if (!time_.empty()) time_.measure_scatter();
    }

    /// The clearest first. The noise is known once all that stands out was taken off; what is no line in it
    /// stays off, and bounds what would have been found.
    [[nodiscard]] std::vector<MotionLine> lines() const {
        std::vector<Taken> lines;
        std::copy_if(taken_.begin(), taken_.end(), std::back_inserter(lines),
                     [this](const Taken& taken) { return is_line(taken); });
        // What was left of a line by the removal of another is none, measured together with that.
        do {
            measure_together(lines);
        } while (std::erase_if(lines, [](const Taken& taken) { return !taken.shown; }) > 0);
        std::vector<MotionLine> found;
        for (Taken& taken : lines) {
            taken.line.false_alarm = false_alarm_of(taken);
            found.push_back(std::move(taken.line));
        }
        return found;
    }
    [[nodiscard]] const SpeedRange& range() const { return range_; }
    [[nodiscard]] const LineScan& angle() const { return angle_; }

    /// The orders at which a line would have been found, with the amplitude that it needs.
    [[nodiscard]] std::optional<SearchedOrders> searched() const {
        constexpr double band = 2.0;  // from one order to its double
        if (angle_.empty()) return std::nullopt;
        SearchedOrders searched{
            angle_.lowest(), angle_.highest(), 0.0, std::max(angle_.deviation_nm(), least_nm_), {}};
        std::vector<SearchedOrders::Bound> bounds, run;
        double all_nm = 0.0;
        for (double from = angle_.lowest(); from < angle_.highest(); from *= band) {
            const double to = std::min(band * from, angle_.highest());
            const double found_nm =
                std::max(angle_.detectable_nm(from, to, false_alarm(), orders_), least_nm_);
            if (std::isfinite(found_nm)) all_nm = std::max(all_nm, found_nm);
            // What was seen and is no line may be one.
            double once_nm = angle_.once_nm(from, to, false_alarm());
            if (!time_.empty()) once_nm = std::max(once_nm, time_.once_nm(from, to, false_alarm()));
            if (!std::isfinite(found_nm) ||
                (found_nm > searched.deviation_nm && !(once_nm > searched.deviation_nm))) {
                run.clear();
                continue;
            }
            double nm = std::max(found_nm, once_nm);
            for (const Taken& taken : taken_) {
                if (taken.line.kind != LineKind::tone && taken.line.order_output >= from &&
                    taken.line.order_output < to && !is_line(taken))
                    nm = std::max(nm, taken.line.amplitude_nm);
            }
            run.push_back({from, nm});
            if (run.size() > bounds.size()) {
                bounds = run;
                searched.highest_order = to;
            }
        }
        if (bounds.empty()) {  // a line would be missed everywhere
            if (!(all_nm > 0.0)) return std::nullopt;
            searched.detectable_nm = all_nm;
            searched.bounds = {{searched.lowest_order, all_nm}};
            return searched;
        }
        searched.lowest_order = bounds.front().from_order;
        // What would have been found from each order on.
        for (std::size_t i = bounds.size() - 1; i-- > 0;)
            bounds[i].detectable_nm = std::max(bounds[i].detectable_nm, bounds[i + 1].detectable_nm);
        searched.detectable_nm = bounds.front().detectable_nm;
        // Only what is less than half of the one before is said.
        for (const auto& bound : bounds) {
            if (searched.bounds.empty() || bound.detectable_nm < 0.5 * searched.bounds.back().detectable_nm)
                searched.bounds.push_back(bound);
        }
        return searched;
    }

  private:
    static constexpr double axes = 2.0;  ///< that are searched
    /// What was taken off, and the evidence of it as an order and as a tone.
    struct Reading {
        const LineScan* scan;
        double place;
        LineScan::Evidences evidences;
    };
    struct Taken {
        KnownLine known;
        MotionLine line;
        std::vector<Reading> readings;
        bool shown = true;  ///< measured together with the others
    };
    /// Places and amplitudes of lines, each given the others.
    void measure_together(std::vector<Taken>& lines) const {
        constexpr int rounds = 2;  // of places
        for (int round = 0; round <= rounds; ++round) {
            std::vector<KnownLine> known;
            for (const Taken& taken : lines) known.push_back(taken.known);
            const LineScan::Together over_angle = angle_.together(known), over_time = time_.together(known);
            for (std::size_t i = 0; i < lines.size(); ++i) {
                const bool by_angle = known[i].axis == Axis::angle;
                const LineScan& scan = by_angle ? angle_ : time_;
                const LineScan::Together& fit = by_angle ? over_angle : over_time;
                Taken& taken = lines[i];
                (by_angle ? taken.line.order_output : taken.line.hz) = known[i].place;
                if (round < rounds) {
                    taken.known.place = scan.refined_alone(fit, known, i);
                    continue;
                }
                measure(scan.sweeps(), scan.noise_at(known[i].place), known[i].place, fit.nm[i], taken.line);
                taken.shown = scan.shows(known[i], fit.nm[i]);
            }
        }
    }
    [[nodiscard]] static double false_alarm_of(const Taken& taken) {
        double chance = 1.0;
        for (const Reading& reading : taken.readings)
            chance = std::min(chance, axes * reading.scan->false_alarm_of(reading.place, reading.evidences));
        return chance;
    }
    [[nodiscard]] bool is_line(const Taken& taken) const {
        return taken.line.amplitude_nm >= least_nm_ && false_alarm_of(taken) < options_.false_alarm;
    }
    [[nodiscard]] double false_alarm() const { return options_.false_alarm / axes; }

    void score() {
        if (!angle_.empty()) angle_scores_ = &angle_.score();
        if (!time_.empty()) time_scores_ = &time_.score();
    }

    [[nodiscard]] static bool is_near(double place, const LineScan& scan, std::span<const double> taken) {
        return std::any_of(taken.begin(), taken.end(),
                           [&](double line) { return std::abs(line - place) < line_cells / scan.longest(); });
    }

    /// Of peaks that are about as clear the lowest: at one speed an order and its images look alike.
    [[nodiscard]] static Peak clearest(const LineScan& scan, const std::vector<double>* scores, double from,
                                       double to, std::span<const double> taken) {
        if (scores == nullptr) return {};
        double most = 0.0;
        std::vector<Peak> peaks;
        for (std::size_t k = 0; k < scores->size(); ++k) {
            const double place = scan.place(k);
            if ((*scores)[k] <= std::max(0.0, most - decisive_nats) || place < from || place > to) continue;
            if (is_near(place, scan, taken)) continue;
            peaks.push_back({place, (*scores)[k]});
            most = std::max(most, (*scores)[k]);
        }
        const auto lowest = std::find_if(peaks.begin(), peaks.end(), [&](const Peak& peak) {
            return peak.evidence >= most - decisive_nats;
        });
        if (lowest == peaks.end()) return {};
        // The top of that peak: by evidence, which a strong line has all over its width, and then by power.
        Peak best = *lowest;
        for (auto next = lowest; next != peaks.end(); ++next)
            if (next->place - lowest->place < line_cells / scan.longest() && next->evidence > best.evidence)
                best = *next;
        best.top = best.place;
        best.place = scan.peak_near(best.place);
        return best;
    }

    /// False when nothing is a line.
    bool take_clearest() {
        constexpr double everywhere = 1e300;
        Peak order = clearest(angle_, angle_scores_, 0.0, everywhere, orders_);
        Peak tone = clearest(time_, time_scores_, 0.0, everywhere, tones_);
        const bool order_is = !angle_.empty() && order.evidence > angle_.threshold(false_alarm());
        const bool tone_is = !time_.empty() && tone.evidence > time_.threshold(false_alarm());
        if (!order_is && !tone_is) return false;
        bool by_angle = order_is && (!tone_is || order.evidence >= tone.evidence);
        const bool first_by_angle = by_angle;
        const double first = by_angle ? order.place : tone.place, top = by_angle ? order.top : tone.top;
        // What another reading explains better may be a line of which the first was a part only, and there is
        // perhaps one of which that is a part: where one order is twice another's at half the speed.
        constexpr int most_rounds = 4;
        Readings best = readings_of(by_angle, first);
        for (int round = 0; round < most_rounds; ++round) {
            if (by_angle ? best.margin >= -decisive_nats : best.margin <= decisive_nats) break;
            by_angle = !by_angle;
            best = readings_of(by_angle, by_angle ? best.order : best.hz);
        }
        const LineKind kind = std::abs(best.margin) <= decisive_nats ? LineKind::unknown
                              : best.margin > 0.0                    ? LineKind::order
                                                                     : LineKind::tone;
        by_angle = kind != LineKind::tone;
        const KnownLine known{by_angle ? Axis::angle : Axis::time, by_angle ? best.order : best.hz};
        Taken taken{known, measured(known, kind, best.hz), {}};
        taken.known.place = by_angle ? taken.line.order_output : taken.line.hz;
        if (is_near(known.place, by_angle ? angle_ : time_, by_angle ? orders_ : tones_) ||
            is_remainder(taken.line, first_by_angle, first)) {
            (first_by_angle ? orders_ : tones_).push_back(first);
            return true;
        }
        const auto read = [&](const LineScan& scan, bool over_angle, double place) {
            if (place > 0.0)
                taken.readings.push_back(
                    {&scan, place,
                     scan.evidences_at(over_angle == first_by_angle && place == first ? top : place)});
        };
        read(angle_, true, best.order);
        read(time_, false, best.hz);
        taken_.push_back(std::move(taken));
        if (by_angle) orders_.push_back(best.order);
        if (kind != LineKind::order) tones_.push_back(best.hz);
        if (!angle_.empty()) angle_.remove(taken_.back().known);
        if (!time_.empty()) time_.remove(taken_.back().known);
        return true;
    }

    /// A line as an order and as a tone, 0 where it is none, and how much more the order explains.
    struct Readings {
        double order = 0.0, hz = 0.0, margin = 0.0;
    };
    /// Of an order, or of a tone, with what the other axis shows where the line could be seen there, and at
    /// the speed of the sweep that shows it best: with several lines in that range the clearest may be
    /// another one.
    [[nodiscard]] Readings readings_of(bool by_angle, double place) const {
        const double reach = line_cells / (by_angle ? time_ : angle_).longest();
        const Sweep& best = (by_angle ? angle_ : time_).strongest_at(place);
        const double speed = std::abs(best.mean_deg_s) / 360.0;
        std::vector<double> others;
        if (by_angle && !time_.empty()) {
            others = {clearest(time_, time_scores_, place * range_.slow / 360.0 - reach,
                               place * range_.fast / 360.0 + reach, {})
                          .place,
                      place * speed};
        } else if (!by_angle && range_.fast > 0.0 && !angle_.empty()) {
            others.push_back(clearest(angle_, angle_scores_, place * 360.0 / range_.fast - reach,
                                      place * 360.0 / std::max(range_.slow, 1e-9) + reach, {})
                                 .place);
            if (speed > 0.0) others.push_back(place / speed);
        }
        constexpr double only_reading = 1e300;
        Readings found = by_angle ? Readings{place, 0.0, only_reading} : Readings{0.0, place, -only_reading};
        for (const double other : others) {
            if (!(other > 0.0)) continue;
            const double margin = by_angle ? margin_of(place, other) : margin_of(other, place);
            if (by_angle ? margin >= found.margin : margin <= found.margin) continue;
            found.margin = margin;
            (by_angle ? found.hz : found.order) = other;
        }
        return found;
    }

    /// Whether a line, first seen at a place of one axis, is what the removal of another left, or the same
    /// where the sweep that shows it best does not resolve the two.
    [[nodiscard]] bool is_remainder(const MotionLine& line, bool by_angle, double place) const {
        constexpr double share = 0.03;  // chosen, not derived: what a removal leaves where the angle is off
        const Sweep& sweep = (by_angle ? angle_ : time_).strongest_at(place);
        const double speed = std::abs(sweep.mean_deg_s) / 360.0;
        const double hz = by_angle ? place * speed : place;
        return std::any_of(taken_.begin(), taken_.end(), [&](const Taken& taken) {
            const double there =
                taken.known.axis == Axis::time ? taken.line.hz : taken.line.order_output * speed;
            const double cells = std::abs(hz - there) * sweep.duration_s;
            return cells < line_cells &&
                   line.amplitude_nm < (cells < 1.0 ? 1.0 : share) * taken.line.amplitude_nm;
        });
    }

    /// How much more (natural units) of what is left of the torque an order explains than a tone, each at its
    /// best near a place. Both are measured over the same rows against one noise, the larger of the two:
    /// where each had its own, what other lines leave in either would decide instead of the line.
    [[nodiscard]] double margin_of(double order, double hz) const {
        // Of a line whose frequency changes by less than it is wide, both show the same.
        const double spread_hz = order * (range_.quick - range_.slow) / 360.0;
        if (!range_.rests && spread_hz * time_.longest() < 1.0) return 0.0;
        LineNoise noise = time_.noise_at(hz);
        const LineNoise over_angle = angle_.noise_at(order);
        const std::span<const Sweep> sweeps = time_.sweeps(), turning = angle_.sweeps();
        LineNoise in_motion{Axis::angle, noise.resolution, std::vector<double>(sweeps.size())};
        std::size_t next = 0;
        for (std::size_t i = 0; i < sweeps.size() && next < turning.size(); ++i) {
            if (turning[next].log != sweeps[i].log || turning[next].first != sweeps[i].first) continue;
            const double power =
                over_angle.power[next] * sweeps[i].weight_square_sum / turning[next].weight_square_sum;
            noise.power[i] = std::max(noise.power[i], power);
            in_motion.power[i] = noise.power[i];
            ++next;
        }
        const double by_time = explained(sweeps, noise, refined(sweeps, noise, hz, 0.5 / time_.longest()));
        const double by_angle =
            explained(sweeps, in_motion, refined(sweeps, in_motion, order, 0.5 / angle_.longest()));
        return by_angle - by_time;
    }

    [[nodiscard]] MotionLine measured(const KnownLine& known, LineKind kind, double tone_hz) const {
        const LineScan& scan = known.axis == Axis::angle ? angle_ : time_;
        const LineNoise noise = scan.noise_at(known.place);
        MotionLine line;
        line.kind = kind;
        const double place = refined(scan.sweeps(), noise, scan.peak_near(known.place), 0.5 / scan.longest());
        const double error = place_error(scan.sweeps(), noise, place);
        (known.axis == Axis::angle ? line.order_output : line.hz) = place;
        (known.axis == Axis::angle ? line.order_stderr : line.hz_stderr) = error;
        std::vector<std::complex<double>> amplitudes;
        for (const Sweep& sweep : scan.sweeps())
            amplitudes.push_back(2.0 * fourier_point(places(sweep, known.axis), sweep.value, place).value /
                                 sweep.weight_sum);
        measure(scan.sweeps(), noise, place, amplitudes, line);
        if (kind == LineKind::unknown) {
            line.hz = tone_hz;
            line.hz_stderr = hann_cell / time_.longest();
        }
        return line;
    }

    const MotionLinesOptions& options_;
    SpeedRange range_;
    double least_nm_;
    LineScan angle_, time_;
    const std::vector<double>*angle_scores_ = nullptr, *time_scores_ = nullptr;
    std::vector<Taken> taken_;
    std::vector<double> orders_, tones_;  ///< places that were taken
};

struct MotionSearch {
    MotionLines found;
    std::vector<std::vector<double>> noise;  ///< of each order in `found`, by sweep that moves
};

std::vector<const MotionLine*> orders_among(const std::vector<MotionLine>& lines) {
    std::vector<const MotionLine*> orders;
    for (const MotionLine& line : lines)
        if (line.kind == LineKind::order) orders.push_back(&line);
    return orders;
}

/// The search for lines in sweeps whose angle is taken as it is.
MotionSearch search_sweeps(const Sweeps& cut, std::span<const TraceView> logs,
                           const MotionLinesOptions& options) {
    MotionSearch search;
    MotionLines& found = search.found;
    for (const Sweep& sweep : cut.pieces) {
        (sweep.rest() ? found.rests : found.sweeps) += 1;
        found.turns += sweep.length_turns;
    }
    found.sweeps_left_out = cut.pieces_left_out;
    found.absolute_angle = cut.absolute_angle;
    if (cut.pieces.empty()) return search;
    const LineSearch lines(cut.pieces, logs, options);
    found.slowest_deg_s = lines.range().slow;
    found.fastest_deg_s = lines.range().fast;
    found.lines = lines.lines();
    if (!cut.absolute_angle)
        for (MotionLine& line : found.lines) line.phase_deg.reset();
    found.searched = lines.searched();
    if (lines.angle().empty()) return search;
    found.resolution_orders = hann_cell / lines.angle().longest();
    found.lowest_order = lines.angle().lowest();
    found.highest_order = lines.angle().highest();
    for (const MotionLine* line : orders_among(found.lines))
        search.noise.push_back(lines.angle().noise_at(line->order_output).power);
    return search;
}

// Chosen, not derived: share of a cycle of the highest order. A line moved by less loses less than a
// hundredth of its height.
constexpr double unseen_cycles = 0.02;

}  // namespace

MotionLines find_motion_lines(std::span<const TraceView> logs, const MotionLinesOptions& options) {
    const Sweeps cut = cut_sweeps(logs, options.sweeps);
    MotionSearch search = search_sweeps(cut, logs, options);
    MotionLines& found = search.found;
    if (found.absolute_angle) return std::move(found);
    std::vector<double> orders;
    for (const MotionLine* line : orders_among(found.lines)) orders.push_back(line->order_output);
    const LineScan scan(cut.pieces, logs, Axis::angle, orders_of(cut.pieces, options));
    const auto fit = fit_velocity_error(logs, scan.sweeps(), search.noise, orders);
    if (!fit) return std::move(found);
    MotionLines again;
    if (fit->most_cycles > unseen_cycles)
        again = search_sweeps(cut_sweeps(logs, options.sweeps, fit->error), logs, options).found;
    if (orders_among(again.lines).empty()) {
        std::size_t next = 0;
        for (MotionLine& line : found.lines)
            if (line.kind == LineKind::order && next < fit->order_shares.size())
                line.order_output *= 1.0 + fit->order_shares[next++];
        again = std::move(found);
    }
    again.velocity_error = fit->error;
    again.order_share_error = fit->order_share_error;
    return again;
}

}  // namespace ripplenotch
