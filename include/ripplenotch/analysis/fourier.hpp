// SPDX-License-Identifier: MIT
#pragma once
// Fourier sums of uniform and of arbitrarily placed samples. The only users of FFTW sit behind these
// functions; plans are estimated, never measured, so that the same input gives the same bits.

#include <complex>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace ripplenotch {

/// Noise bandwidth of a Hann window, in bins of one over its length.
inline constexpr double hann_cell = 1.5;

/// X[k] = sum over n of x[n] exp(-2 pi i k n / N) for k = 0 .. N/2; N = x.size() > 0, any length.
[[nodiscard]] std::vector<std::complex<double>> real_fourier(std::span<const double> x);

/// The same for many signals of one length, without copies: fill in(), then run().
class RealTransform {
  public:
    /// length > 0.
    explicit RealTransform(std::size_t length);
    ~RealTransform();
    RealTransform(RealTransform&&) noexcept;
    RealTransform& operator=(RealTransform&&) noexcept;

    [[nodiscard]] std::span<double> in();
    /// length / 2 + 1 sums, valid until the next run; in() stays as it is.
    std::span<const std::complex<double>> run();

  private:
    struct Arrays;
    std::unique_ptr<Arrays> arrays_;
};

/// The smallest length >= at_least without prime factors above 7, for transforms whose length is free.
[[nodiscard]] std::size_t fast_length(std::size_t at_least);

/// S[k] = sum over j of value[j] exp(-2 pi i k spacing where[j]) for k = 0 .. count - 1, at any places
/// `where` (unit: 1/unit of spacing). Equal to the direct sum within 1e-9 of sum |value|. O(n + count log
/// count). Method: spreading with the kernel of Kaiser and Bessel, transform, division by the kernel's own
/// transform (Jackson et al., IEEE Trans. Medical Imaging 10, 1991). No interpolation takes place on the
/// samples.
[[nodiscard]] std::vector<std::complex<double>> nonuniform_fourier(std::span<const double> where,
                                                                   std::span<const double> value,
                                                                   double spacing, std::size_t count);

/// The same sum at one frequency, with its first two derivatives by frequency; for refining a peak. O(n).
struct FourierPoint {
    std::complex<double> value, first, second;
};
[[nodiscard]] FourierPoint fourier_point(std::span<const double> where, std::span<const double> value,
                                         double frequency);

/// Where a maximum is looked for: about a frequency, at most so far from it.
struct PeakGuess {
    double frequency = 0.0, reach = 0.0;
};
/// Nearest maximum of |sum| to the guess, by Newton steps.
[[nodiscard]] double refine_peak(std::span<const double> where, std::span<const double> value,
                                 const PeakGuess& guess);

}  // namespace ripplenotch
