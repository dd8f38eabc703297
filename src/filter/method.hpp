// SPDX-License-Identifier: MIT
#pragma once
#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/design/running_design.hpp"
#include "ripplenotch/filter/method.hpp"

namespace ripplenotch::filter_methods {

#define METHOD(name) extern const Method name;
#include "filter/methods/methods.def"
#undef METHOD

}  // namespace ripplenotch::filter_methods

namespace ripplenotch {

// Methods as numbers to run on, each from the file of its method.

[[nodiscard]] TrackingDesign tracking_design(const Settings& settings, Hertz sample_rate);
/// Throws UsageError for settings that no code is written for: scheduled gains, angles from the velocity, a
/// zero to be found.
[[nodiscard]] OscillatorDesign oscillator_design(const Settings& settings, Hertz sample_rate);

}  // namespace ripplenotch
