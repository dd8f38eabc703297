// SPDX-License-Identifier: MIT
#include "log/step_watch.hpp"

#include <algorithm>
#include <bit>
#include <utility>

namespace ripplenotch {
namespace {

constexpr double near_share = 0.1;  // the guess is good when the median is this near
constexpr double rounding = 1e-12;

/// The median of the steps that advance; 0 when none does.
double usual_step(std::span<const double> time_s) {
    std::vector<double> steps;
    for (std::size_t i = 1; i < time_s.size(); ++i) {
        if (time_s[i] > time_s[i - 1]) steps.push_back(time_s[i] - time_s[i - 1]);
    }
    if (steps.empty()) return 0.0;
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::nth_element(steps.begin(), middle, steps.end());
    return *middle;
}

}  // namespace

void StepWatch::take(std::span<const double> time_s) {
    if (guess_s_) {
        for (const double time : time_s) take(time);
        return;
    }
    early_s_.insert(early_s_.end(), time_s.begin(), time_s.end());
    if (early_s_.size() < 2) return;
    guess_s_ = usual_step(early_s_);
    take(std::exchange(early_s_, {}));
}

void StepWatch::take(double time_s) {
    ++troubles_.rows;
    if (before_s_) take_step(time_s);
    before_s_ = time_s;
}

void StepWatch::take_step(double time_s) {
    const double step = time_s - *before_s_, guess = *guess_s_;
    zeros_ += step == 0.0;
    below_ += step > 0.0 && step < (1.0 - near_share) * guess;
    near_ += step > 0.0 && step >= (1.0 - near_share) * guess && step <= (1.0 + near_share) * guess;
    if (gap_s() > 0.0 && step > gap_s()) {
        shortest_gap_s_ = std::min(shortest_gap_s_, step);
        troubles_.add_gap({count_, *before_s_, time_s});
    } else {
        duration_s_ += step;
        ++counted_;
        longest_counted_s_ = std::max(longest_counted_s_, step);
    }
    ++count_;
    troubles_.repeated_times = zeros_;
}

// A clock coarser than the rows repeats itself: then the steps that do advance are shared out.
std::size_t StepWatch::usual_rank() const {
    const std::size_t median = count_ / 2;
    return median >= zeros_ ? median - zeros_ : (count_ - zeros_) / 2;
}

bool StepWatch::settled() const {
    if (!advances()) return true;  // no usual step, and so no gap
    const double guess = guess_s_.value_or(0.0), rank = static_cast<double>(usual_rank());
    if (!(guess > 0.0) || rank < static_cast<double>(below_) || rank >= static_cast<double>(below_ + near_))
        return false;
    return longest_counted_s_ <= gap_s() * (1.0 - near_share) * (1.0 - rounding) &&
           shortest_gap_s_ > gap_s() * (1.0 + near_share) * (1.0 + rounding);
}

Hertz StepWatch::sample_rate() const {
    if (!(duration_s_ > 0.0)) return Hertz(0.0);
    const double mean = duration_s_ / static_cast<double>(counted_);
    return Hertz(1.0 / mean);
}

void StepOfRank::take(std::span<const double> time_s) {
    for (const double time : time_s) {
        const double step = before_s_ ? time - *before_s_ : 0.0;
        before_s_ = time;
        if (!(step > 0.0)) continue;
        // Positive numbers are in the order of their bits.
        const auto bits = std::bit_cast<std::uint64_t>(step);
        const bool alike = unknown_bits_ == 64 || bits >> unknown_bits_ == known_;
        if (alike) ++counts_[bits >> (unknown_bits_ - digit_bits) & (counts_.size() - 1)];
    }
}

bool StepOfRank::next_digit() {
    std::size_t digit = 0;
    while (digit + 1 < counts_.size() && rank_ >= counts_[digit]) rank_ -= counts_[digit++];
    known_ = known_ << digit_bits | digit;
    unknown_bits_ -= digit_bits;
    std::fill(counts_.begin(), counts_.end(), 0);
    before_s_.reset();
    return unknown_bits_ > 0;
}

double StepOfRank::value() const { return std::bit_cast<double>(known_); }

}  // namespace ripplenotch
