// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/rows/row_facts.hpp"
#include "log/clock/clock_check.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/log/clock.hpp"

namespace ripplenotch {

namespace {

// The part of the clock that sees where its rate changes for good.

constexpr double usual_duration = 0.1;  ///< share by which a window's time differs without a closer look
constexpr double other_rate = 1.35;     ///< steps longer or shorter by this are of another rate ...
constexpr std::size_t windows_to_change = 4;  ///< ... when so many windows in a row have them

constexpr std::size_t scouted_rows = 512;  ///< that tell how the opening begins
constexpr double alike_steps = 1.25;       // by hand: as a factor
// Times of more rows than these in one say too little of when each was taken: with five, ripple of 11 to 33
// Hz in 1 kHz rows was found with eleven false lines, with four its amplitudes were up to 8 % low.
constexpr double most_rows_a_time = 4.5;

// By hand: of times of arrival a long step stands alone among short ones so often.
constexpr double most_lone_gaps = 1.0 / 40.0;

// Rows a burst, where rows come in bursts; else 0.
double burst_rows(std::span<const double> time_s, double limit_s) {
    std::size_t alone = 0;
    const auto is_long = [&](std::size_t k) { return time_s[k] - time_s[k - 1] > limit_s; };
    for (std::size_t k = 2; k + 1 < time_s.size(); ++k)
        alone += is_long(k) && !is_long(k - 1) && !is_long(k + 1);
    const auto rows = static_cast<double>(time_s.size());
    return static_cast<double>(alone) > most_lone_gaps * rows ? rows / static_cast<double>(alone) : 0.0;
}

bool longer(const Gap& a, const Gap& b) { return a.to_s - a.from_s > b.to_s - b.from_s; }

}  // namespace

void Clock::end_window() {
    const double duration = window_.time_s.back() - window_.time_s.front();
    const double usual = now_.rows_step_s * static_cast<double>(window_steps);
    if (std::abs(duration - usual) <= usual_duration * usual)
        odd_windows_ = 0;
    else
        look_closely(advancing_steps(window_.time_s));
    sum_up_window();
    if (odd_windows_ == windows_to_change) change_rate();
    std::swap(before_, window_);
    window_.first_row = before_.first_row + window_steps;
    window_.time_s.assign(1, before_.time_s.back());
    summed_up_ = 0;
}

void Clock::look_closely(std::vector<double> steps_s) {
    const double median_s = steps_s.empty() ? 0.0 : median_in(steps_s);
    if (!(median_s > 0.0) || within_factor(median_s, now_.step_s, other_rate)) {
        odd_windows_ = 0;
    } else if (odd_windows_ > 0 && within_factor(median_s, odd_step_s_, other_rate)) {
        ++odd_windows_;
    } else {
        odd_windows_ = 1;
        odd_step_s_ = median_s;
        odd_since_s_ = window_.time_s.back();
        odd_row_ = change_row(median_s);
        odd_row_s_ = odd_row_ < window_.first_row ? before_.time_s[odd_row_ - before_.first_row]
                                                  : window_.time_s[odd_row_ - window_.first_row];
    }
}

// The row within this window and the one before that parts the steps best into those of now and those of
// `step_s`. A run that begins with this window changed before its first row.
std::size_t Clock::change_row(double step_s) const {
    std::vector<double> time_s = before_.time_s;
    std::size_t first = window_.first_row;
    if (!time_s.empty()) {
        first = before_.first_row;
        time_s.pop_back();
    }
    time_s.insert(time_s.end(), window_.time_s.begin(), window_.time_s.end());
    const double between = std::sqrt(step_s * now_.step_s);
    const bool slower = step_s > now_.step_s;
    long score = 0, best_score = 0;
    std::size_t best = 0;
    for (std::size_t k = 1; k < time_s.size(); ++k) {
        const bool old = (time_s[k] - time_s[k - 1] > between) != slower;
        score += old ? 1 : -1;
        if (score > best_score) {
            best_score = score;
            best = k;
        }
    }
    return first + best;
}

void Clock::change_rate() {
    const double rows = static_cast<double>((windows_to_change - 1) * window_steps);
    const double step_s = (window_.time_s.back() - odd_since_s_) / rows;
    RateChange change{odd_row_, odd_row_s_, now_.rate, ripplenotch::nominal_rate(Hertz(1.0 / step_s))};
    if (pending_gap_) {  // the first step at the slower rate, after which a run has begun already
        change.row = pending_gap_->row;
        change.time_s = pending_gap_->from_s;
        pending_gap_.reset();
    }
    if (facts_.rate_changes.size() < most_listed_gaps) facts_.rate_changes.push_back(change);
    slow_steps_.clear();
    long_step_s_ = 0.0;
    end_run();
    run_at({odd_step_s_, step_s, change.to});
    usable_ = std::abs(change.to / facts_.nominal_rate - 1.0) <= rate_refused;
    restart_ = true;
    odd_windows_ = 0;
}

Clock::Clock(std::string source, std::span<const double> opening_s, std::optional<Hertz> stated)
    : source_(std::move(source)) {
    if (stated) {
        facts_.stated = true;
        facts_.nominal_rate = facts_.mean_rate = *stated;
        facts_.usual_step = Seconds(1.0 / stated->value());
        limit_s_ = gap_steps / stated->value();
        return;
    }
    timed_ = !opening_s.empty() && std::ranges::all_of(opening_s, [](double t) { return std::isfinite(t); });
    if (timed_) open(opening_s);
    facts_.refusal = refusal(opening_s.size());
}

Clock::Clock(std::string source, Rate rate, Hertz nominal)
    : source_(std::move(source)), timed_(true), advances_(true) {
    facts_.nominal_rate = nominal;
    run_at(rate);
}

void Clock::run_at(Rate rate) {
    now_ = rate;
    limit_s_ = gap_steps * rate.step_s;
}

// How the opening begins tells where its rate changes; its longest part at one rate is the nominal one.
void Clock::open(std::span<const double> opening_s) {
    const auto rate_of = [](const RateEstimate& estimate) {
        return Rate{estimate.step_s, 1.0 / estimate.mean.value(), estimate.nominal};
    };
    RateEstimate first = estimate_rate(opening_s.first(std::min(scouted_rows, opening_s.size())));
    if (!(first.step_s > 0.0)) first = estimate_rate(opening_s);
    advances_ = first.step_s > 0.0;
    if (!advances_) return;
    Clock scout(source_, rate_of(first), first.nominal);
    scout.add(opening_s);
    std::size_t begin = 0, most = 0;
    const auto end_part = [&](std::size_t end) {
        const RateEstimate part = estimate_rate(opening_s.subspan(begin, end - begin));
        if (begin == 0) first = part;
        if (end - begin > most) {
            most = end - begin;
            facts_.nominal_rate = part.nominal;
            facts_.usual_step = Seconds(part.step_s);
        }
        begin = end;
    };
    for (const RateChange& change : scout.facts_.rate_changes) end_part(change.row + 1);
    end_part(opening_s.size());
    run_at(rate_of(first));
    rows_a_time_ = first.step_s * first.mean.value();
    rows_a_burst_ = burst_rows(opening_s, limit_s_);
    over_all_ = Hertz(static_cast<double>(opening_s.size() - 1) / (opening_s.back() - opening_s.front()));
    usable_ = std::abs(first.nominal / facts_.nominal_rate - 1.0) <= rate_refused;
}

std::string Clock::refusal(std::size_t rows) const {
    if (facts_.stated) return {};
    if (rows < 2) {
        return fmt::format(
            "read {} of data, expected at least two, which determine the sample rate; check what wrote it",
            rows == 0 ? "no row" : "one row");
    }
    if (!timed_) return "no column of time; state the rate of its rows, for example --sample-rate 1kHz";
    const auto state_rate = [&] {
        return fmt::format(
            "state the rate of its rows, over all its time {:.4g} Hz: for example --sample-rate {:.4g}Hz",
            over_all_.value(), ripplenotch::nominal_rate(over_all_).value());
    };
    if (rows_a_time_ > most_rows_a_time)
        return fmt::format(
            "time advances once in {:.0f} rows, too seldom to determine when each was taken; {}",
            rows_a_time_, state_rate());
    if (rows_a_burst_ > 0.0)
        return fmt::format(
            "time comes in bursts of {:.0f} rows, {:.3g} s apart and then none for long, as of arrival; {}",
            rows_a_burst_, now_.step_s, state_rate());
    if (advances_) return {};
    return "time does not advance from row to row; state the rate of its rows, for example --sample-rate "
           "1kHz, or name the right column with --columns time=NAME";
}

void Clock::require() const {
    if (!facts_.refusal.empty()) raise<DataError>("{}: {}", source_, facts_.refusal);
}

void Clock::begin_part(std::size_t at, bool usable) { parts_.push_back({at, 0, true, usable}); }

void Clock::end_run() {
    sum_up_window();
    if (run_begin_s_) duration_s_ += *last_s_ - *run_begin_s_;
    run_begin_s_.reset();
}

void Clock::begin_run(double time_s, std::size_t at) {
    begin_part(at, usable_);
    end_run();
    if (usable_) run_begin_s_ = time_s;
    before_.time_s.clear();
    window_ = {facts_.rows + at, {time_s}};
    summed_up_ = 0;
    odd_windows_ = 0;
    restart_ = false;
}

std::span<const RunPart> Clock::add(std::span<const double> time_s) {
    parts_.assign(1, {0, 0, false, usable_ && slow_steps_.empty()});
    if (!time_s.empty()) {
        if (facts_.rows == 0) facts_.first_s = time_s.front();
        facts_.last_s = time_s.back();
    }
    const bool watched = timed_ && advances_;
    for (std::size_t k = 0; watched && k < time_s.size();) {
        if (!last_s_ || restart_) {
            begin_run(time_s[k], k);
            last_s_ = time_s[k++];
        } else if (const std::size_t count = usual_rows(time_s.subspan(k)); count > 0) {
            if (!slow_steps_.empty()) {
                end_slow_spell();
                begin_run(time_s[k], k);
                last_s_ = time_s[k++];
                continue;
            }
            note_pending_gap();
            long_step_s_ = 0.0;
            add_rows(time_s.subspan(k, count));
            k += count;
        } else {
            add_odd(time_s[k], k);
            last_s_ = time_s[k++];
        }
        if (window_.time_s.size() > window_steps) end_window();
    }
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        const std::size_t end = i + 1 < parts_.size() ? parts_[i + 1].first : time_s.size();
        parts_[i].count = end - parts_[i].first;
        if (!parts_[i].usable) facts_.rows_left_out += parts_[i].count;
    }
    if (parts_.size() > 1 && parts_.front().count == 0) parts_.erase(parts_.begin());
    facts_.rows += time_s.size();
    return parts_;
}

// How many rows from here on follow within the limit, of those that the window has room for.
std::size_t Clock::usual_rows(std::span<const double> time_s) const {
    const double step = time_s.front() - *last_s_;
    if (!(step > 0.0 && step <= limit_s_)) return 0;
    const std::size_t room = window_steps + 1 - window_.time_s.size();
    return first_step_outside(time_s.first(std::min(room, time_s.size())), 0.0, limit_s_);
}

void Clock::add_rows(std::span<const double> time_s) {
    window_.time_s.insert(window_.time_s.end(), time_s.begin(), time_s.end());
    last_s_ = time_s.back();
}

// What is summed up does not depend on the blocks: steps by windows, time by whole runs.
void Clock::sum_up_window() {
    const auto steps = std::span(window_.time_s).subspan(std::min(summed_up_, window_.time_s.size()));
    if (steps.size() < 2) return;
    const StepSums sums = sum_up_steps(steps, facts_.usual_step.value());
    summed_up_ = window_.time_s.size() - 1;
    shortest_s_ = std::min(shortest_s_, sums.shortest_s);
    longest_s_ = std::max(longest_s_, sums.longest_s);
    if (!run_begin_s_) return;
    squares_ += sums.squares;
    steps_ += steps.size() - 1;
}

void Clock::add_odd(double time_s, std::size_t at) {
    const double step = time_s - *last_s_;
    if (step < 0.0) {
        raise<DataError>(
            "{}: data row {}: time runs backward, from {} s to {} s; put the rows in order, or count the "
            "rows at a stated rate with --sample-rate",
            source_, facts_.rows + at + 1, shortest(*last_s_), shortest(time_s));
    }
    if (step > 0.0) {
        add_long(time_s, at);
        return;
    }
    ++facts_.repeated_times;
    add_rows({&time_s, 1});
}

// The second long step of a length tells that the first was no gap, or that gaps come in rows. Either way
// there is no filter for such rows; what they were is known some windows later.
void Clock::add_long(double time_s, std::size_t at) {
    const double step = time_s - *last_s_;
    const Gap here{facts_.rows + at - 1, *last_s_, time_s};
    shortest_s_ = std::min(shortest_s_, step);
    longest_s_ = std::max(longest_s_, step);
    const bool again = long_step_s_ > 0.0 && within_factor(step, long_step_s_, alike_steps);
    long_step_s_ = step;
    if (again) {
        if (slow_steps_.empty()) {
            begin_part(at, false);
            end_run();
        }
        slow_steps_.push_back(here);
        window_.time_s.push_back(time_s);
        return;
    }
    end_slow_spell();
    note_pending_gap();
    pending_gap_ = here;
    begin_run(time_s, at);
}

void Clock::note(const Gap& gap) {
    if (facts_.gap_count++ == 0 || longer(gap, facts_.longest_gap)) facts_.longest_gap = gap;
    if (facts_.gaps.size() < most_listed_gaps) facts_.gaps.push_back(gap);
}

void Clock::note_pending_gap() {
    if (pending_gap_) note(*pending_gap_);
    pending_gap_.reset();
}

void Clock::end_slow_spell() {
    if (slow_steps_.empty()) return;
    note_pending_gap();
    for (const Gap& gap : std::exchange(slow_steps_, {})) note(gap);
}

ClockFacts Clock::facts() const {
    Clock told = *this;
    told.end_slow_spell();
    told.note_pending_gap();
    told.end_run();
    ClockFacts facts = std::move(told.facts_);
    if (told.longest_s_ > 0.0) {
        facts.shortest_step = Seconds(told.shortest_s_);
        facts.longest_step = Seconds(told.longest_s_);
    }
    if (!(told.duration_s_ > 0.0)) return facts;
    const double steps = static_cast<double>(told.steps_), mean_s = told.duration_s_ / steps;
    const double off = mean_s - facts.usual_step.value();
    facts.mean_rate = Hertz(1.0 / mean_s);
    facts.jitter = Seconds(std::sqrt(std::max(told.squares_ / steps - off * off, 0.0)));
    return facts;
}

}  // namespace ripplenotch
