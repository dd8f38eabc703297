// SPDX-License-Identifier: MIT
#include "analysis/spectrum/running_median.hpp"

#include <algorithm>
#include <cmath>

namespace ripplenotch {
namespace {

// Ranks kept to each side of the median: four deviations of where the next window of the same noise has its.
std::size_t ranks_beside(std::size_t count) {
    return static_cast<std::size_t>(2.0 * std::sqrt(static_cast<double>(count))) + 8;
}

}  // namespace

void RunningMedian::start(std::size_t first, std::size_t end) {
    const auto window = signal_.subspan(first, end - first);
    window_.assign(window.begin(), window.end());
    const std::size_t middle = window.size() / 2, beside = ranks_beside(window.size());
    const auto lowest = window_.begin() + static_cast<std::ptrdiff_t>(middle - std::min(middle, beside));
    const auto highest =
        window_.begin() + static_cast<std::ptrdiff_t>(std::min(window.size() - 1, middle + beside));
    std::nth_element(window_.begin(), lowest, window_.end());
    low_ = *lowest;
    std::nth_element(lowest, highest, window_.end());
    high_ = *highest;
    below_ = std::count_if(window_.begin(), lowest, [this](double value) { return value < low_; });
    const double apart = high_ - low_;
    buckets_a_unit_ = apart > 1e-300 ? static_cast<double>(bucket_count) / apart : 0.0;
    for (std::vector<double>& bucket : buckets_) bucket.clear();
    near_ = 0;
    for (const double value : window_) {
        if (!(value >= low_ && value <= high_)) continue;
        bucket_of(value).push_back(value);
        ++near_;
    }
}

// Values rise with their buckets, whatever is rounded.
std::vector<double>& RunningMedian::bucket_of(double value) {
    const double place = std::min((value - low_) * buckets_a_unit_, static_cast<double>(bucket_count - 1));
    return buckets_[static_cast<std::size_t>(place)];
}

// Where values come in no order, a branch on one is guessed wrong every other time: there are none but one.
void RunningMedian::move_on(std::size_t first, std::size_t end) {
    for (const double value : take_near(signal_.subspan(first_, first - first_), -1)) {
        std::vector<double>& bucket = bucket_of(value);
        *std::find(bucket.begin(), bucket.end(), value) = bucket.back();
        bucket.pop_back();
    }
    for (const double value : take_near(signal_.subspan(end_, end - end_), 1))
        bucket_of(value).push_back(value);
}

std::span<const double> RunningMedian::take_near(std::span<const double> values, std::ptrdiff_t each) {
    window_.resize(std::max(window_.size(), values.size()));
    std::size_t taken = 0;
    std::ptrdiff_t below = 0;
    for (const double value : values) {
        window_[taken] = value;
        below += static_cast<std::ptrdiff_t>(value < low_);
        taken += static_cast<std::size_t>(value >= low_ && value <= high_);
    }
    below_ += each * below;
    near_ += each * static_cast<std::ptrdiff_t>(taken);
    return std::span(window_).first(taken);
}

double RunningMedian::near(std::size_t rank) {
    for (std::vector<double>& bucket : buckets_) {
        if (rank < bucket.size()) {
            const auto place = bucket.begin() + static_cast<std::ptrdiff_t>(rank);
            std::nth_element(bucket.begin(), place, bucket.end());
            return *place;
        }
        rank -= bucket.size();
    }
    return high_;  // never: the rank is below near_
}

double RunningMedian::at(std::size_t first, std::size_t count) {
    const std::size_t end = first + count;
    const bool onward = first >= first_ && end >= end_;
    const bool little = onward && first - first_ + end - end_ < count / 2;
    if (little) move_on(first, end);
    const auto rank = [&] { return static_cast<std::ptrdiff_t>(count / 2) - below_; };
    if (!little || rank() < 0 || rank() >= near_) start(first, end);
    first_ = first;
    end_ = end;
    return near(static_cast<std::size_t>(rank()));
}

}  // namespace ripplenotch
