// SPDX-License-Identifier: MIT
#include "analysis/spectrum/running_median.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace ripplenotch {

namespace {

// Ranks kept to each side of the median: four deviations of where the next window of the same noise has its.
std::size_t ranks_beside(std::size_t count) {
    return static_cast<std::size_t>(2.0 * std::sqrt(static_cast<double>(count))) + 8;
}

}  // namespace

void RunningMedian::start(std::size_t first, std::size_t end) {
    const auto window = signal_.subspan(first, end - first);
    scratch_.assign(window.begin(), window.end());
    const std::size_t middle = window.size() / 2, beside = ranks_beside(window.size());
    const auto lowest = scratch_.begin() + static_cast<std::ptrdiff_t>(middle - std::min(middle, beside));
    const auto highest =
        scratch_.begin() + static_cast<std::ptrdiff_t>(std::min(window.size() - 1, middle + beside));
    std::nth_element(scratch_.begin(), lowest, scratch_.end());
    low_ = *lowest;
    std::nth_element(lowest, highest, scratch_.end());
    const double apart = *highest - low_;
    buckets_a_unit_ = apart > 1e-300 ? static_cast<double>(bucket_count - 3) / apart : 0.0;
    counts_.fill(0);
    middle_ = below_ = 0;
    come(first, end);
}

// Buckets rise with the values, whatever is rounded.
std::uint8_t RunningMedian::bucket_of(double value) const {
    const double place = (value - low_) * buckets_a_unit_ + 1.0;
    const double last = static_cast<double>(bucket_count - 1);
    return static_cast<std::uint8_t>(std::max(0.0, std::min(last, place)));
}

// Where values come in no order, a branch on one is guessed wrong every other time: there are none.
void RunningMedian::come(std::size_t first, std::size_t end) {
    for (std::size_t k = first; k < end; ++k) {
        const std::uint8_t bucket = bucket_of(signal_[k]);
        bucket_[k] = bucket;
        ++counts_[bucket];
        below_ += static_cast<std::size_t>(bucket < middle_);
    }
}

void RunningMedian::move_on(std::size_t first, std::size_t end) {
    for (std::size_t k = first_; k < first; ++k) {
        const std::uint8_t bucket = bucket_[k];
        --counts_[bucket];
        below_ -= static_cast<std::size_t>(bucket < middle_);
    }
    come(end_, end);
}

bool RunningMedian::settle(std::size_t rank) {
    while (rank < below_) below_ -= counts_[--middle_];
    while (rank >= below_ + counts_[middle_]) below_ += counts_[middle_++];
    return middle_ > 0 && middle_ + 1 < bucket_count;
}

double RunningMedian::inside(std::size_t rank) {
    scratch_.clear();
    const std::uint8_t *const begin = bucket_.data(), *const end = begin + end_;
    const auto next = [&](const std::uint8_t* from) {
        return static_cast<const std::uint8_t*>(
            std::memchr(from, static_cast<int>(middle_), static_cast<std::size_t>(end - from)));
    };
    for (auto* at = next(begin + first_); at != nullptr; at = next(at + 1))
        scratch_.push_back(signal_[static_cast<std::size_t>(at - begin)]);
    const auto place = scratch_.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(scratch_.begin(), place, scratch_.end());
    return *place;
}

double RunningMedian::at(std::size_t first, std::size_t count) {
    const std::size_t end = first + count;
    const bool onward = first >= first_ && end >= end_;
    const bool little = onward && first - first_ + end - end_ < count / 2;
    if (little) move_on(first, end);
    if (!little || !settle(count / 2)) {
        start(first, end);
        settle(count / 2);
    }
    first_ = first;
    end_ = end;
    return inside(count / 2 - below_);
}

}  // namespace ripplenotch
