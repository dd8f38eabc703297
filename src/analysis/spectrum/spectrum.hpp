// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "analysis/spectrum/order_map.hpp"
#include "analysis/spectrum/stack.hpp"
#include "ripplenotch/analysis/line_test.hpp"
#include "ripplenotch/analysis/spectrum.hpp"
#include "ripplenotch/analysis/steady.hpp"

namespace ripplenotch {

/// Bins of the main lobe at zero of what the removal of a straight line leaves.
inline constexpr std::size_t trend_bins = 3;

/// Largest amplitude that a line of amplitude 1 shows `bins` away through a Hann window, side lobes included.
[[nodiscard]] double leakage(double bins);

inline constexpr double skirt_margin = 2.0;  ///< a side lobe may be this much higher than the window's own

/// Independent averages that half-overlapping Hann pieces are worth: neighbours share a sixth of their
/// amplitude and so 1/36 of their power in correlation, (1 + 2/36)^-1.
[[nodiscard]] double independent_pieces(std::size_t pieces);

// The mean spectrum of pieces that go by one after another: once for the power, and once more for the lines
// found in it.

class Welch {
  public:
    /// `length` samples a piece.
    Welch(std::size_t length, Hertz rate);

    /// First pass: consecutive samples, seconds and Nm. Returns how many are done with: the others are to
    /// come again, in front of those that follow them.
    std::size_t add(std::span<const double> time_s, std::span<const double> torque_nm);
    /// The result with another rate from the beginning on; empty where it cannot be determined.
    [[nodiscard]] std::optional<Welch> at(Hertz rate) const;
    /// Between the passes. False when there is no line, and so no need of a second pass.
    bool find_lines(double false_alarm);
    /// Second pass, the same samples in the same way.
    std::size_t measure(std::span<const double> time_s, std::span<const double> torque_nm);

    [[nodiscard]] Spectrum spectrum() const;

  private:
    [[nodiscard]] PowerSpectrum tested() const;
    [[nodiscard]] double bin_hz() const { return rate_ / static_cast<double>(length_); }
    [[nodiscard]] SpectralPeak peak(std::size_t line) const;
    [[nodiscard]] std::vector<double> power_without_lines() const;
    [[nodiscard]] std::vector<SpectralHump> humps() const;

    std::size_t length_;
    double rate_;
    PieceMaker maker_;
    std::size_t pieces_ = 0;
    std::vector<double> power_;  // squared amplitude of a line, sum over pieces; the mean from find_lines on
    double gain_ = 0.0;          // ratio of density times rate to squared amplitude, likewise
    std::vector<double> floor_;  // mean noise power
    std::vector<SignificantPeak> found_;
    std::vector<SignificantHump> humps_;
    std::vector<LineMeter> meters_;
};

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
