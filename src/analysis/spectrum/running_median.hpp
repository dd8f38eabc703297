// SPDX-License-Identifier: MIT
#pragma once
// Median of a window that moves along a signal in steps much shorter than itself.

#include <cstddef>
#include <span>
#include <vector>

namespace ripplenotch {

class RunningMedian {
  public:
    explicit RunningMedian(std::span<const double> signal) : signal_(signal) {}

    /// The element of rank count / 2 of signal[first .. first + count), count > 0. Where the window has moved
    /// on by less than half of itself, and its median not far, that takes a few steps for each sample that
    /// comes or goes; else one pass over the window.
    double at(std::size_t first, std::size_t count);

  private:
    void start(std::size_t first, std::size_t end);
    void move_on(std::size_t first, std::size_t end);
    /// Those from low_ to high_; `each` that is below counts in below_. Valid until the next call.
    std::span<const double> take_near(std::span<const double> values, std::ptrdiff_t each);
    /// Of the first in near_ that is not less.
    [[nodiscard]] std::vector<double>::const_iterator place_of(double value) const;

    std::span<const double> signal_;
    std::size_t first_ = 0, end_ = 0;
    // What of the window lies from low_ to high_, about the median, in order; and how many lie below.
    double low_ = 0.0, high_ = 0.0;
    std::vector<double> near_, window_;
    std::ptrdiff_t below_ = 0;
};

}  // namespace ripplenotch
