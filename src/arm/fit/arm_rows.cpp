// SPDX-License-Identifier: MIT
#include "arm/fit/arm_rows.hpp"

#include <cmath>
#include <numbers>

#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

// Wide enough for a log's speed to be told from zero, narrow enough for friction to turn at once.
constexpr double width_deg_s = 1.5, stribeck_deg_s = 8.6;

}  // namespace

FrictionBeside friction_beside(double speed_deg_s) {
    const double side = portable::tanh(speed_deg_s / width_deg_s), slow = speed_deg_s / stribeck_deg_s;
    return {side, slow * slow < 700.0 ? side * portable::exp(-slow * slow) : 0.0};
}

double deg_s_of(JointKind kind) { return kind == JointKind::revolute ? 1.0 : 1800.0 / std::numbers::pi; }

ArmRows::ArmRows(const Chain& chain, std::span<const Motion> motions, std::span<const Motion> friction,
                 std::size_t joint)
    : links_(values_of_a_link * chain.size()),
      joint_(joint),
      states_(chain, motions),
      arm_(chain),
      friction_(friction[joint]),
      unit_(deg_s_of(chain.joints[joint].kind)) {}

void ArmRows::at(std::size_t k, std::span<double> row) {
    const auto states = states_.at(k);
    arm_.move(states);
    arm_.torque_of(joint_, row.first(links_));
    const double v_deg_s = unit_ * friction_.velocity_deg_s[k], v = v_deg_s * std::numbers::pi / 180.0;
    const FrictionBeside friction = friction_beside(v_deg_s);
    const std::span<double> own = row.subspan(links_);
    own[0] = states[joint_].acceleration;
    own[1] = 1.0;
    own[2] = friction.side;
    own[3] = v;
    own[4] = friction.stribeck;
    own[5] = std::abs(friction.side);
    own[6] = std::abs(v);
}

}  // namespace ripplenotch
