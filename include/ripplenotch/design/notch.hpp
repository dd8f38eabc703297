// SPDX-License-Identifier: MIT
#pragma once
// Notches: second-order sections that remove one frequency.

#include <cstddef>
#include <span>
#include <string_view>

#include "ripplenotch/core/biquad.hpp"
#include "ripplenotch/core/quantity.hpp"

namespace ripplenotch {

/// Butterworth low-pass of any order (order 1: one real pole), bilinear, prewarped at the cut-off (-3 dB).
struct LowPassSpec {
    Hertz cutoff;
    int order = 1;  ///< as the paper's
};

/// Sections in series, a first-order section first when the order is odd. Throws UsageError unless
/// 0 < cutoff < sample_rate / 2 and 1 <= order <= 20.
[[nodiscard]] Cascade design_low_pass(const LowPassSpec& spec, Hertz sample_rate);

// Step figures of a cascade, measured on its own sampled response.

struct StepFigures {
    Seconds settle;                  ///< time after which the step response stays within the band
    double overshoot_percent = 0.0;  ///< highest point above the final value; 0 when it never passes it
};

/// Response to a unit step at t = 0 from steady state, run until it has certainly settled. `band_percent` is
/// half the width of the band around the final value, 0 < band_percent < 100. Throws UsageError on an
/// unstable cascade or one that needs more than 5e7 samples.
[[nodiscard]] StepFigures measure_step(std::span<const Biquad> cascade, Hertz sample_rate,
                                       double band_percent);

/// Samples after which a step response has surely come within `remainder` (0 < remainder < 1) of its final
/// value. Throws UsageError on an unstable cascade or one that needs more than 5e7 samples.
[[nodiscard]] std::size_t samples_to_settle(std::span<const Biquad> cascade, double remainder);

inline constexpr double infinite_depth_db = 1e300;  ///< stands for a gain of 0

/// The definition of Q once the filter is sampled.
enum class WidthRule {
    analog,   ///< Q of the analogue prototype H(s); bilinear transform prewarped at the centre (the paper's
              ///< twin-T)
    digital,  ///< the -3 dB bandwidth of the sampled filter is exactly center / Q in Hz
              ///< (scipy.signal.iirnotch, MATLAB)
};
[[nodiscard]] std::string_view width_rule_name(WidthRule rule);

/// H(s) = (s^2 + g (w0/Q) s + w0^2) / (s^2 + (w0/Q) s + w0^2) with g = 10^(-depth_db/20); infinite depth
/// gives g = 0. Q = 1/4 is the twin-T of Kim, Kim, Song 2011, eq. 2 with w0 = 1/(RC).
struct NotchSpec {
    Hertz center;
    double q = 0.25;                      ///< center / bandwidth at -3 dB (infinite depth)
    double depth_db = infinite_depth_db;  ///< attenuation at the center; infinite_depth_db for a full null
    WidthRule width = WidthRule::analog;
};

/// The centre is exact under both rules. Throws UsageError, naming value and limit, unless 0 < center <
/// sample_rate / 2, q > 0 and depth_db > 0.
[[nodiscard]] Biquad design_notch(const NotchSpec& spec, Hertz sample_rate);

/// One section as two trapezoidal integrators (A. Simper, Linear Trapezoidal Integrated SVF, 2013). With
/// g = tan(pi f0 / fs) and k = 1/Q: a1 = 1 / (1 + g (g + k)), a2 = g a1, a3 = g a2, and per sample
///   v3 = x - s2;  v1 = a1 s1 + a2 v3;  v2 = s2 + a2 s1 + a3 v3;  s1 = 2 v1 - s1;  s2 = 2 v2 - s2;
///   y = m0 x + m1 v1 + m2 v2.
/// A notch is m0 = 1, m1 = -(1 - gain at the centre) k, m2 = 0. In steady state v1 is 0 whatever the
/// rounding, so
/// its gain at 0 Hz is exactly 1.
struct SvfSection {
    double a1 = 1.0, a2 = 0.0, a3 = 0.0;
    double m0 = 1.0, m1 = 0.0, m2 = 0.0;
};

/// Its integrators: m0 = 1, m1 = m2 = 0.
[[nodiscard]] SvfSection svf_at(double g, double k);
/// A notch in this form. The notch is one that design_notch takes.
[[nodiscard]] SvfSection svf_of(const NotchSpec& notch, Hertz sample_rate);

}  // namespace ripplenotch
