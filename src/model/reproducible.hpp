// SPDX-License-Identifier: MIT
#pragma once
// Cosine, sine, logarithm, exponential from +, -, *, / and square roots alone. Those are exact to the last
// bit on every IEEE machine; the C library's own are not (they are chosen at run time by instruction set, and
// differ between versions). So a simulated log has the same bytes wherever it is made.

namespace ripplenotch {

/// Within 2 units in the last place of 1. Exact at multiples of 90 degrees, with period 360 degrees to the
/// last bit. Any finite angle.
[[nodiscard]] double cos_degrees(double angle_deg);
[[nodiscard]] double sin_degrees(double angle_deg);

/// Natural logarithm of a positive, normal, finite number; relative error below 1e-15 away from 1.
[[nodiscard]] double natural_log(double x);

/// e to the power x for -700 <= x <= 700; relative error below 1e-15.
[[nodiscard]] double exponential(double x);

/// x to the power p for x >= 0 and p > 0, where the result is within 1e-300 and 1e300; 0 for x below 1e-300.
/// A power of 1 is exact.
[[nodiscard]] double power(double x, double p);

/// Hyperbolic tangent of any finite number, odd to the last bit; absolute error below 1e-15.
[[nodiscard]] double smooth_sign(double x);

}  // namespace ripplenotch
