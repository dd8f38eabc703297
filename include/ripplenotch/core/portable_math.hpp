// SPDX-License-Identifier: MIT
#pragma once
// The functions of <cmath> that IEEE 754 leaves open, from +, -, *, / and square roots alone. Those are exact
// to the last bit on every machine; the C library's own are not (they are chosen at run time by instruction
// set, and differ between versions). So the same log gives the same bytes wherever it is read.
// docs/decisions/0004-same-bytes.md.

#include <complex>
#include <numbers>
#include <span>

namespace ripplenotch::portable {

/// cos(angle) + i sin(angle), the bits of both, for little more than the price of one.
[[nodiscard]] std::complex<double> phasor(double angle_rad);

}  // namespace ripplenotch::portable

namespace ripplenotch {

inline constexpr double full_turn = 2.0 * std::numbers::pi;  ///< in radians

}  // namespace ripplenotch

namespace ripplenotch::portable {

/// Within 2 units in the last place of 1, of an angle in radians. Beyond 1e9 rad an angle's own last bit is
/// coarser than that, and the multiple of 2 pi that is taken off is rounded like it.
[[nodiscard]] double cos(double angle_rad);
[[nodiscard]] double sin(double angle_rad);
[[nodiscard]] double tan(double angle_rad);

/// Within 2 units in the last place of 1. Exact at multiples of 90 degrees, with period 360 degrees to the
/// last bit. Any finite angle; of others no number.
[[nodiscard]] double cos_degrees(double angle_deg);
[[nodiscard]] double sin_degrees(double angle_deg);
/// The same bits for each of many angles, faster. The second span is as long as the first, or longer.
void cos_degrees(std::span<const double> angle_deg, std::span<double> cosine);
void sin_degrees(std::span<const double> angle_deg, std::span<double> sine);

/// In radians, relative error below 4e-16; quadrants, zeros and infinities as in <cmath>.
[[nodiscard]] double atan(double x);
[[nodiscard]] double atan2(double y, double x);
[[nodiscard]] double asin(double x);
[[nodiscard]] double acos(double x);

/// Relative error below 1e-15. Infinities and numbers outside the domain as in <cmath>.
[[nodiscard]] double exp(double x);
[[nodiscard]] double exp2(double x);
[[nodiscard]] double log(double x);
[[nodiscard]] double log1p(double x);
/// log10() of a power of ten and log2() of a power of two are whole numbers.
[[nodiscard]] double log10(double x);
[[nodiscard]] double log2(double x);

/// x to the power p. Exact where the product of whole powers up to 8 is; relative error below 1e-15 for x =
/// 10; otherwise below 1e-15 (1 + |p log x|).
[[nodiscard]] double pow(double x, double p);
[[nodiscard]] double cbrt(double x);

/// Odd to the last bit; absolute error below 1e-15.
[[nodiscard]] double tanh(double x);
/// Logarithm of the gamma function of a positive number, absolute or relative error below 1e-13.
[[nodiscard]] double lgamma(double x);

/// No overflow between. One unit in the last place.
[[nodiscard]] double hypot(double x, double y);
[[nodiscard]] double hypot(double x, double y, double z);

[[nodiscard]] inline double arg(const std::complex<double>& z) { return atan2(z.imag(), z.real()); }
[[nodiscard]] inline std::complex<double> polar(double size, double angle_rad) {
    return {size * cos(angle_rad), size * sin(angle_rad)};
}

}  // namespace ripplenotch::portable
