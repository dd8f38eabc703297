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
