// SPDX-License-Identifier: MIT
#include "filter/motor_angle.hpp"

#include <cmath>

namespace ripplenotch {
namespace {
constexpr double checked_every_turns = 1.0;  ///< of the motor; position and velocity are compared this often
}

void MotorAngle::restart() noexcept {
    started_ = false;
    from_velocity_ = false;
}

void MotorAngle::next(double velocity_deg_s, const double* position_deg, double correction_deg_s) noexcept {
    if (!started_) {
        started_ = true;
        from_velocity_ = position_deg == nullptr || source_ == Source::velocity;
        joint_deg_ = position_deg != nullptr ? *position_deg : start_deg_;
        step_turns_ = checked_velocity_deg_ = checked_position_deg_ = 0.0;
    } else {
        const double by_velocity = 0.5 * (last_velocity_ + velocity_deg_s) * step_s_;
        double moved = by_velocity + correction_deg_s * step_s_;
        if (!from_velocity_ && position_deg != nullptr) {
            moved = *position_deg - last_position_;
            if (std::abs(moved) > 180.0) moved -= 360.0 * std::round(moved / 360.0);
            check(by_velocity, moved);
        }
        joint_deg_ += moved;
        step_turns_ = gear_ratio_ * moved / 360.0;
    }
    last_velocity_ = velocity_deg_s;
    if (position_deg != nullptr) last_position_ = *position_deg;
}

// A position that does half, or twice, of what the velocity says is no position of this joint.
void MotorAngle::check(double by_velocity_deg, double by_position_deg) noexcept {
    checked_velocity_deg_ += by_velocity_deg;
    checked_position_deg_ += by_position_deg;
    const double far = 360.0 * checked_every_turns / gear_ratio_;
    if (std::abs(checked_velocity_deg_) < far && std::abs(checked_position_deg_) < far) return;
    const double ratio = checked_position_deg_ / checked_velocity_deg_;
    if (!(ratio > 0.5 && ratio < 2.0)) from_velocity_ = true;
    checked_velocity_deg_ = checked_position_deg_ = 0.0;
}

}  // namespace ripplenotch
