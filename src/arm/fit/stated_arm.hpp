// SPDX-License-Identifier: MIT
#pragma once
#include <span>
#include <vector>

#include "ripplenotch/arm/arm_fit.hpp"
#include "ripplenotch/core/quantity.hpp"

namespace ripplenotch {

// Torque of an arm without the noise that its acceleration brings.

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

// A log of an arm's joints as the fit may use it.

struct CheckedLog {
    const ArmLog& log;
    std::vector<Motion> friction;     ///< motions with the speed that friction uses
    std::vector<std::size_t> fitted;  ///< joints whose torque counts
    std::vector<bool> use;            ///< by row
};

/// Throws as fit_arm. Rows in which nothing moves for more than a second count only in that second: the
/// others carry no further information.
[[nodiscard]] CheckedLog check_log(const Chain& chain, const ArmLog& log, const ArmFitOptions& options);

}  // namespace ripplenotch
