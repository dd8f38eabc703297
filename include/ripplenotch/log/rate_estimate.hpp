// SPDX-License-Identifier: MIT
#pragma once
// The rate of times that run at one rate.

#include <span>

#include "ripplenotch/core/units.hpp"

namespace ripplenotch {

/// A gap is a step of more than so many usual ones.
inline constexpr double default_gap_steps = 10.0;

/// A controller's rate when the measured rate, or its period, is within 0.1 % of a number with two
/// significant digits: that number, so that two logs of one controller get the same coefficients. 1000.3 Hz
/// gives 1000 Hz, 124.96 Hz (8.0026 ms) gives 125 Hz, 978.4 Hz stays.
[[nodiscard]] Hertz nominal_rate(Hertz measured);

/// Steps and rates of times that run at one rate.
struct RateEstimate {
    Hertz nominal, mean;
    double step_s = 0.0;  ///< median of the steps that advance; 0 when none does
};
[[nodiscard]] RateEstimate estimate_rate(std::span<const double> time_s,
                                         double gap_steps = default_gap_steps);

}  // namespace ripplenotch
