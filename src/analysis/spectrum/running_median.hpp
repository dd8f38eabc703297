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

    /// The element of rank count / 2 of signal[first .. first + count), count > 0. One pass over the window
    /// when it has moved on by less than half of itself, else a sort.
    double at(std::size_t first, std::size_t count);

  private:
    void start(std::size_t first, std::size_t end);
    void move_on(std::size_t first, std::size_t end);

    std::span<const double> signal_;
    std::size_t first_ = 0, end_ = 0;
    std::vector<double> sorted_, staying_, leaving_, coming_;
};

}  // namespace ripplenotch
