// SPDX-License-Identifier: MIT
#pragma once
// Notches: second-order sections that take out one frequency.

#include <string_view>

#include "ripplenotch/core/biquad.hpp"
#include "ripplenotch/core/units.hpp"

namespace ripplenotch {

inline constexpr double infinite_depth_db = 1e300;  ///< stands for a gain of 0

/// What Q means once the filter is sampled.
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

}  // namespace ripplenotch
