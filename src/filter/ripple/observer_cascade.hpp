// SPDX-License-Identifier: MIT
#pragma once
// The settled Kalman filter at one speed, written as second-order sections, so that delay and attenuation can
// be read off as for any other filter.

#include "filter/ripple/ripple_kalman.hpp"
#include "ripplenotch/core/biquad.hpp"

namespace ripplenotch {

/// From the measured torque to the torque estimate, or to the measured torque less the ripple estimate. Gain
/// 1 at 0 Hz. `gain` is in the frame of ripple_rotation; empty at standstill, where ripple and torque cannot
/// be told apart and the amplitudes stand still.
[[nodiscard]] Cascade settled_cascade(const RippleModel& model, double step_turns, std::vector<double> gain,
                                      bool minus_ripple);

}  // namespace ripplenotch
