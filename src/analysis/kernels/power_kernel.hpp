// SPDX-License-Identifier: MIT
#pragma once
// Squared magnitudes of Fourier sums, added up.

#include <complex>
#include <span>
#include <vector>

namespace ripplenotch {

/// power[k] += scale * |sums[k]|^2.
void add_power(std::span<const std::complex<double>> sums, double scale, std::span<double> power);

/// The same for the transform of a real signal of even length, from the transform of half that length whose
/// complex signal is the real one's samples by twos. Method: H. V. Sorensen, D. L. Jones, M. T. Heideman, C.
/// S. Burrus, "Real-valued fast Fourier transform algorithms", IEEE Trans. ASSP 35 (1987) 849-863, section
/// IV.
class HalfPower {
  public:
    /// `length` of the real signal, even, at least 4.
    explicit HalfPower(std::size_t length);
    /// length / 2 sums; length / 2 + 1 powers.
    void add(std::span<const std::complex<double>> sums, double scale, std::span<double> power) const;

  private:
    std::vector<double> cosine_, sine_;  // of 2 pi k / length, to a quarter of a turn
};

}  // namespace ripplenotch
