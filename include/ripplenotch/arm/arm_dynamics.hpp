// SPDX-License-Identifier: MIT
#pragma once
// The torque of an arm's rigid bodies: linear in ten values a link.

#include <cstddef>
#include <span>
#include <vector>

#include "ripplenotch/arm/chain.hpp"
#include "ripplenotch/model/effect.hpp"

namespace ripplenotch {

/// The values of each link, in this order: mass (kg); mass times position of its centre x, y, z (kg m);
/// inertia about the origin of the link's frame xx, xy, xz, yy, yz, zz (kg m^2). All in the link's frame.
inline constexpr std::size_t values_of_a_link = 10;

/// The torque of one joint that one unit of each value brings: 10 columns a link of the chain, from the base
/// on, each with an entry per sample. `motions` are those of the joints in the order of the chain, of equal
/// length; of a prismatic joint the fields that are named for degrees hold metres, and its torque is a force
/// in newtons. Columns of links before `joint` are 0. The recursion is that of Newton and Euler, written for
/// unknown masses (Khosla 1986; Siciliano et al., Robotics, 2009, section 7.5).
[[nodiscard]] std::vector<std::vector<double>> arm_columns(const Chain& chain,
                                                           std::span<const Motion> motions,
                                                           std::size_t joint);

/// The torque in newton-metres of one joint of an arm whose values are known: 10 a link.
[[nodiscard]] std::vector<double> arm_torque(const Chain& chain, std::span<const double> values,
                                             std::span<const Motion> motions, std::size_t joint);

/// How many combinations of its values are identifiable by any motion: from the torques of all joints
/// together, and from those of one joint alone.
[[nodiscard]] std::size_t arm_values_there(const Chain& chain);
[[nodiscard]] std::size_t arm_values_there(const Chain& chain, std::size_t joint);

/// Whether an inertia that turns with the motor of this joint alone can be distinguished from the links'.
[[nodiscard]] bool rotor_is_identifiable(const Chain& chain, std::size_t joint);

}  // namespace ripplenotch
