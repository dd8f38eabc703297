// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace ripplenotch {

// Median of a window that moves along a signal in steps much shorter than itself.

class RunningMedian {
  public:
    explicit RunningMedian(std::span<const double> signal) : signal_(signal), bucket_(signal.size()) {}

    /// The element of rank count / 2 of signal[first .. first + count), count > 0. Where the window has moved
    /// on by less than half of itself, and its median not far, that takes a few steps for each sample that
    /// comes or goes; else one pass over the window.
    double at(std::size_t first, std::size_t count);

  private:
    void start(std::size_t first, std::size_t end);
    void move_on(std::size_t first, std::size_t end);
    void come(std::size_t first, std::size_t end);
    /// Finds the bucket of this rank; false where it is one of those for what lies far from the median.
    bool settle(std::size_t rank);
    /// The value of this rank in the bucket of the median.
    [[nodiscard]] double inside(std::size_t rank);
    [[nodiscard]] std::uint8_t bucket_of(double value) const;

    std::span<const double> signal_;
    std::size_t first_ = 0, end_ = 0;
    // The values about the median lie in narrow buckets, all others in the first and the last. In each bucket
    // is less than in the next; of the window is known how many each has.
    static constexpr std::size_t bucket_count = 256;
    std::vector<std::uint8_t> bucket_;  ///< bucket of each sample of the window
    std::array<std::uint32_t, bucket_count> counts_{};
    double low_ = 0.0, buckets_a_unit_ = 0.0;
    std::size_t middle_ = 0, below_ = 0;  ///< a bucket, and how many lie in those before it
    std::vector<double> scratch_;
};

}  // namespace ripplenotch
