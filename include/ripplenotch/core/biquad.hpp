// SPDX-License-Identifier: MIT
#pragma once
// Second-order sections: coefficients are values, memory is somebody else's.

#include <complex>
#include <span>
#include <vector>

#include "ripplenotch/core/quantity.hpp"

namespace ripplenotch {

/// y[k] = b0 x[k] + b1 x[k-1] + b2 x[k-2] - a1 y[k-1] - a2 y[k-2]; a0 is 1 by construction.
struct Biquad {
    double b0 = 1.0, b1 = 0.0, b2 = 0.0, a1 = 0.0, a2 = 0.0;
    bool operator==(const Biquad&) const = default;
};

/// Sections in series, first to last.
using Cascade = std::vector<Biquad>;

/// Memory of one section in transposed direct form II.
struct BiquadState {
    double s1 = 0.0, s2 = 0.0;
};

/// The new output is what the next sample waits for, so it comes last in each sum.
inline double step(const Biquad& f, BiquadState& s, double x) noexcept {
    const double y = f.b0 * x + s.s1;
    s.s1 = f.b1 * x + s.s2 - f.a1 * y;
    s.s2 = f.b2 * x - f.a2 * y;
    return y;
}

/// Output of a section for a constant input of 1.
[[nodiscard]] double dc_gain(const Biquad& f) noexcept;

/// Complex gain of a section or cascade at a frequency, 0 <= at <= sampled.rate / 2.
[[nodiscard]] std::complex<double> response(const Biquad& f, Hertz at, SampledAt sampled);
[[nodiscard]] std::complex<double> response(std::span<const Biquad> cascade, Hertz at, SampledAt sampled);

/// -d(phase)/d(omega) in seconds, from the polynomials themselves (no differencing, finite at a notch's own
/// zero as long as the zero is not exactly on the circle at `at`).
[[nodiscard]] Seconds group_delay(std::span<const Biquad> cascade, Hertz at, SampledAt sampled);

/// Largest pole radius; below 1 means stable.
[[nodiscard]] double pole_radius(const Biquad& f);
[[nodiscard]] double pole_radius(std::span<const Biquad> cascade);

}  // namespace ripplenotch
