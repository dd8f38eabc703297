// SPDX-License-Identifier: MIT
#pragma once
#include "ripplenotch/analysis/sweeps.hpp"

namespace ripplenotch {

/// Internal to the analysis module: sets the sweep's torque, and its value, to the residual of the measured
/// torque after the smooth part, by least squares under the weights. Cost O(n terms).
void take_off_smooth_part(Sweep& sweep);

}  // namespace ripplenotch
