// SPDX-License-Identifier: MIT
#pragma once
#include "ripplenotch/core/biquad.hpp"
#include "ripplenotch/core/units.hpp"

namespace ripplenotch {

/// Butterworth low-pass of any order (order 1: one real pole), bilinear, prewarped at the cut-off (-3 dB).
struct LowPassSpec {
    Hertz cutoff;
    int order = 1;  ///< as the paper's
};

/// Sections in series, a first-order section first when the order is odd. Throws UsageError unless
/// 0 < cutoff < sample_rate / 2 and 1 <= order <= 20.
[[nodiscard]] Cascade design_low_pass(const LowPassSpec& spec, Hertz sample_rate);

}  // namespace ripplenotch
