// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace ripplenotch {

// Median of a window that moves along a signal.

class RunningMedian {
  public:
    explicit RunningMedian(std::span<const double> signal) : signal_(signal) {}

    /// The element of rank count / 2 of signal[first .. first + count), count > 0. Each sample that comes or
    /// goes is put into or taken out of the sorted window; of many at once the window is sorted anew.
    double at(std::size_t first, std::size_t count) {
        const std::size_t end = first + count;
        const std::size_t moved = first - first_ + (end > end_ ? end - end_ : end_ - end);
        // From here on sorting costs less, at 100 samples as at 10,000.
        constexpr std::size_t many = 64;
        if (first < first_ || first >= end_ || moved > many) {
            const auto window = signal_.subspan(first, count);
            sorted_.assign(window.begin(), window.end());
            std::sort(sorted_.begin(), sorted_.end());
            first_ = first;
            end_ = end;
        }
        for (; end_ < end; ++end_)
            sorted_.insert(std::upper_bound(sorted_.begin(), sorted_.end(), signal_[end_]), signal_[end_]);
        while (end_ > end) take_out(--end_);
        while (first_ < first) take_out(first_++);
        return sorted_[count / 2];
    }

  private:
    void take_out(std::size_t sample) {
        sorted_.erase(std::lower_bound(sorted_.begin(), sorted_.end(), signal_[sample]));
    }

    std::span<const double> signal_;
    std::vector<double> sorted_;
    std::size_t first_ = 0, end_ = 0;
};

}  // namespace ripplenotch
