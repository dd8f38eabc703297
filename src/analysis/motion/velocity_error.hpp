// SPDX-License-Identifier: MIT
#pragma once
// Internal to the analysis module: the effect of the velocity error on the angle of a log without position,
// determined from the ripple itself.

#include <optional>
#include <span>
#include <vector>

#include "ripplenotch/analysis/sweeps.hpp"

namespace ripplenotch {

struct VelocityFit {
    VelocityError error;
    /// Relative error that all orders have in common: from the offset, which is only known within its
    /// error, and from the velocity's noise, which its sum adds up.
    double order_share_error = 0.0;
    std::vector<double> order_shares;  ///< by how much of itself each order of the fit lies higher
    /// Largest shift of a sample within its sweep by the offset, in cycles of the highest order.
    double most_cycles = 0.0;
};

/// One offset of the velocity of all logs that have no position. An angle that is a sum of velocities is off
/// by -offset * t, and ripple of order n is out of phase by 2 pi n times that: the offset and the position of
/// each line that make the summed power of the lines over their noise largest, which are the likeliest where
/// each sweep has an amplitude and a phase of its own. The prior of the offset: normal, 1 % of the fastest
/// speed. The errors (sandwich) include noise of torque, the velocity's noise, and the uncertainty of the
/// other unknowns. Needs at most four lines, the clearest.
///
/// `sweeps`: those of a LineScan over the angle, no line removed; `noise` has the power of the noise by order
/// and sweep, 0 where a sweep is not used; `orders` are cycles per output turn, the clearest first. Empty
/// where the power has no clear maximum. Cost O(samples * orders).
[[nodiscard]] std::optional<VelocityFit> fit_velocity_error(std::span<const TraceView> logs,
                                                            std::span<const Sweep> sweeps,
                                                            std::span<const std::vector<double>> noise,
                                                            std::span<const double> orders);

}  // namespace ripplenotch
