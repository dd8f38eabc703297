// SPDX-License-Identifier: MIT
#include "analysis/spectrum/running_median.hpp"

#include <algorithm>

namespace ripplenotch {
namespace {

void sort_into(std::vector<double>& sorted, std::span<const double> values) {
    sorted.assign(values.begin(), values.end());
    std::sort(sorted.begin(), sorted.end());
}

}  // namespace

void RunningMedian::start(std::size_t first, std::size_t end) {
    sort_into(sorted_, signal_.subspan(first, end - first));
}

void RunningMedian::move_on(std::size_t first, std::size_t end) {
    sort_into(leaving_, signal_.subspan(first_, first - first_));
    sort_into(coming_, signal_.subspan(end_, end - end_));
    staying_.resize(sorted_.size() - leaving_.size());
    std::set_difference(sorted_.begin(), sorted_.end(), leaving_.begin(), leaving_.end(), staying_.begin());
    sorted_.resize(staying_.size() + coming_.size());
    std::merge(staying_.begin(), staying_.end(), coming_.begin(), coming_.end(), sorted_.begin());
}

double RunningMedian::at(std::size_t first, std::size_t count) {
    const std::size_t end = first + count;
    const bool onward = first >= first_ && end >= end_;
    if (onward && first - first_ + end - end_ < count / 2)
        move_on(first, end);
    else
        start(first, end);
    first_ = first;
    end_ = end;
    return sorted_[count / 2];
}

}  // namespace ripplenotch
