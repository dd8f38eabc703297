// SPDX-License-Identifier: MIT
#pragma once
// Median of a window that moves along a signal in steps much shorter than itself.

#include <array>
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
    [[nodiscard]] std::vector<double>& bucket_of(double value);
    /// Of those from low_ to high_, the one of this rank.
    [[nodiscard]] double near(std::size_t rank);

    std::span<const double> signal_;
    std::size_t first_ = 0, end_ = 0;
    // What of the window lies from low_ to high_, about the median, and how many lie below. In each bucket is
    // less than in the next, in no order: one comes and goes without moving others.
    static constexpr std::size_t bucket_count = 64;
    double low_ = 0.0, high_ = 0.0, buckets_a_unit_ = 0.0;
    std::array<std::vector<double>, bucket_count> buckets_;
    std::vector<double> window_;
    std::ptrdiff_t below_ = 0, near_ = 0;
};

}  // namespace ripplenotch
