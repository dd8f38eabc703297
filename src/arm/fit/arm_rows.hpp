// SPDX-License-Identifier: MIT
#pragma once
// What one unit of every value brings to the torque of one joint, sample by sample: links, rotor, friction.

#include <span>
#include <vector>

#include "arm/dynamics/arm_states.hpp"
#include "ripplenotch/arm/arm_fit.hpp"

namespace ripplenotch {

/// The values of a joint's own: rotor, then what is beside the arm.
inline constexpr std::size_t values_of_a_joint = 1 + values_beside_arm;

/// Shapes of friction beside an arm at one speed: the side of the motion, and how much of it is slow.
struct FrictionBeside {
    double side, stribeck;
};
[[nodiscard]] FrictionBeside friction_beside(double speed_deg_s);
/// A joint's speed as these shapes take it: of a prismatic joint, whose speed is in metres, that of a turn on
/// 0.1 m.
[[nodiscard]] double deg_s_of(JointKind kind);

class ArmRows {
  public:
    /// `friction`: the motions whose speed friction sees. All must outlive this.
    ArmRows(const Chain& chain, std::span<const Motion> motions, std::span<const Motion> friction,
            std::size_t joint);

    [[nodiscard]] std::size_t size() const { return states_.size(); }
    /// Ten a link and values_of_a_joint.
    [[nodiscard]] std::size_t values() const { return links_ + values_of_a_joint; }
    void at(std::size_t sample, std::span<double> row);

  private:
    std::size_t links_, joint_;
    ArmStates states_;
    ArmRow arm_;
    const Motion& friction_;
    double unit_;
};

}  // namespace ripplenotch
