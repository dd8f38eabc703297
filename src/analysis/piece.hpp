// SPDX-License-Identifier: MIT
#pragma once
// Pieces of a log for spectra: a straight line taken out, a Hann window, the transform. One after another in
// the same memory.

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "ripplenotch/analysis/fourier.hpp"
#include "ripplenotch/core/units.hpp"

namespace ripplenotch {

struct Piece {
    std::span<const double> time_s;  ///< from the piece's middle
    std::span<const double> value;   ///< detrended and windowed, Nm
    bool even = false;               ///< time_s is PieceMaker::even_time_s()
    double middle_s = 0.0;
    double window_sum = 0.0, window_square_sum = 0.0;
};

class PieceMaker {
  public:
    PieceMaker(std::size_t length, Hertz rate);

    /// From `length` samples, in seconds and Nm, of which so many at the beginning were the last ones of the
    /// piece before. What is returned holds until the next one.
    const Piece& make(std::span<const double> time_s, std::span<const double> torque_nm,
                      std::size_t repeated = 0);
    /// Sums of that piece at the multiples of rate / length, 0 Hz to half the rate.
    std::span<const std::complex<double>> transform();

    [[nodiscard]] std::span<const double> even_time_s() const { return even_time_s_; }

  private:
    void make_even(std::span<const double> torque_nm);
    void make_uneven(std::span<const double> time_s, std::span<const double> torque_nm);

    double rate_, step_s_;
    RealTransform transform_;
    std::vector<double> even_time_s_, even_window_;
    double even_sum_ = 0.0, even_square_sum_ = 0.0;
    std::vector<double> time_s_, value_;
    std::vector<std::complex<double>> uneven_sums_;
    Piece piece_;
};

}  // namespace ripplenotch
