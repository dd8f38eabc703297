// SPDX-License-Identifier: MIT
// The part of the clock that sees where its rate changes for good.

#include <algorithm>
#include <cmath>
#include <utility>

#include "log/clock/step_sums.hpp"
#include "ripplenotch/core/median.hpp"
#include "ripplenotch/log/clock.hpp"

namespace ripplenotch {
namespace {

constexpr double usual_duration = 0.1;  ///< share by which a window's time differs without a closer look
constexpr double other_rate = 1.35;     ///< steps longer or shorter by this are of another rate ...
constexpr std::size_t windows_to_change = 4;  ///< ... when so many windows in a row have them

double median_step(const std::vector<double>& time_s) {
    std::vector<double> steps;
    for (std::size_t k = 1; k < time_s.size(); ++k) {
        if (time_s[k] > time_s[k - 1]) steps.push_back(time_s[k] - time_s[k - 1]);
    }
    if (steps.empty()) return 0.0;
    return median_in(steps);
}

}  // namespace

void Clock::end_window() {
    const double duration = window_.time_s.back() - window_.time_s.front();
    const double usual = now_.rows_step_s * static_cast<double>(window_steps);
    if (std::abs(duration - usual) <= usual_duration * usual)
        odd_windows_ = 0;
    else
        look_closely(median_step(window_.time_s));
    sum_up_window();
    if (odd_windows_ == windows_to_change) change_rate();
    std::swap(before_, window_);
    window_.first_row = before_.first_row + window_steps;
    window_.time_s.assign(1, before_.time_s.back());
    summed_up_ = 0;
}

void Clock::look_closely(double median_s) {
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

}  // namespace ripplenotch
