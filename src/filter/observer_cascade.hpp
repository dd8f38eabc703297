// SPDX-License-Identifier: MIT
#pragma once
// The settled Kalman filter at one speed, written as second-order sections, so that delay and attenuation can
// be read off as for any other filter.

#include "filter/ripple_kalman.hpp"
#include "ripplenotch/core/biquad.hpp"

namespace ripplenotch {

/// From the measured torque to the torque estimate, or to the measured torque less the ripple estimate. Gain
/// 1 at 0 Hz. At standstill, where ripple and torque cannot be told apart, the amplitudes stand still.
[[nodiscard]] Cascade settled_cascade(const RippleModel& model, double step_turns, bool minus_ripple);

}  // namespace ripplenotch
