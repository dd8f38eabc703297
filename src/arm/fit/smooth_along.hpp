// SPDX-License-Identifier: MIT
#pragma once
// Torque of an arm without the noise that its acceleration brings.

#include <span>
#include <vector>

#include "ripplenotch/core/units.hpp"

namespace ripplenotch {

/// At each time the middle of the parabola that fits the values within half a window best, nearer ones
/// weighing more, (1 - u^2)^2: a torque that changes slowly stays as it is, and the sides of a window's own
/// transform, which let noise through a plain least squares, are low. Three values or fewer in a window are
/// left alone.
[[nodiscard]] std::vector<double> smooth_along(std::span<const double> time_s, std::span<const double> values,
                                               Seconds window);
/// The same of many columns over the same times.
[[nodiscard]] std::vector<std::vector<double>> smooth_along(std::span<const double> time_s,
                                                            std::span<const std::vector<double>> columns,
                                                            Seconds window);

}  // namespace ripplenotch
