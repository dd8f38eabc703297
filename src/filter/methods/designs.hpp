// SPDX-License-Identifier: MIT
#pragma once
// Methods as numbers to run on, each from the file of its method.

#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/core/units.hpp"
#include "ripplenotch/design/running_design.hpp"

namespace ripplenotch {

[[nodiscard]] TrackingDesign tracking_design(const Settings& settings, Hertz sample_rate);
/// Throws UsageError for settings that no code is written for: scheduled gains, angles from the velocity, a
/// zero to be found.
[[nodiscard]] OscillatorDesign oscillator_design(const Settings& settings, Hertz sample_rate);

}  // namespace ripplenotch
