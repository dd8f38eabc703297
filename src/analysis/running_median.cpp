// SPDX-License-Identifier: MIT
#include "analysis/running_median.hpp"

#include <algorithm>

namespace ripplenotch {

void RunningMedian::start(std::size_t first, std::size_t end) {
    const auto window = signal_.subspan(first, end - first);
    sorted_.assign(window.begin(), window.end());
    std::sort(sorted_.begin(), sorted_.end());
}

void RunningMedian::insert(double value) {
    sorted_.insert(std::upper_bound(sorted_.begin(), sorted_.end(), value), value);
}

/// Moves what stands between the place of the one and that of the other by one.
void RunningMedian::replace(double old, double value) {
    const auto from = std::lower_bound(sorted_.begin(), sorted_.end(), old);
    if (value >= old) {
        const auto to = std::upper_bound(from, sorted_.end(), value);
        std::move(from + 1, to, from);
        *(to - 1) = value;
    } else {
        const auto to = std::upper_bound(sorted_.begin(), from, value);
        std::move_backward(to, from, from + 1);
        *to = value;
    }
}

double RunningMedian::at(std::size_t first, std::size_t count) {
    const std::size_t end = first + count;
    const bool near = first >= first_ && end >= end_ && first - first_ + end - end_ < count / 2;
    if (!near) {
        start(first, end);
    } else {
        while (first_ < first && end_ < end) replace(signal_[first_++], signal_[end_++]);
        while (end_ < end) insert(signal_[end_++]);
        while (first_ < first)
            sorted_.erase(std::lower_bound(sorted_.begin(), sorted_.end(), signal_[first_++]));
    }
    first_ = first;
    end_ = end;
    return sorted_[count / 2];
}

}  // namespace ripplenotch
