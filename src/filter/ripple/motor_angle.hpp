// SPDX-License-Identifier: MIT
#pragma once
// The motor's angle from what a log has: position, else the velocity added up.

#include <cstdint>

namespace ripplenotch {

/// Feeds on samples in order. From the position where there is one, which is the joint's then (unwrapped at
/// half turns of the joint); else from the velocity by trapezoids. While the motor turns slowly, a position
/// that trembles about the velocity is smoothed: to whoever ties a ripple to the angle, a trembling angle
/// under a steady torque says that there is none.
class MotorAngle {
  public:
    enum class Source : std::uint8_t { best, velocity };

    /// `start_deg` is the joint's position at the first sample where no position says it.
    MotorAngle(double gear_ratio, double sample_rate_hz, Source source, double start_deg) noexcept
        : gear_ratio_(gear_ratio), step_s_(1.0 / sample_rate_hz), source_(source), start_deg_(start_deg) {}

    void restart() noexcept;
    /// `position_deg` may be null. `correction_deg_s` is added to the velocity, where that is what counts.
    void next(double velocity_deg_s, const double* position_deg, double correction_deg_s = 0.0) noexcept;

    [[nodiscard]] double turns() const noexcept {
        return gear_ratio_ * joint_deg_ / 360.0;
    }                                                                         ///< of the motor
    [[nodiscard]] double step_turns() const noexcept { return step_turns_; }  ///< since the sample before
    [[nodiscard]] bool from_velocity() const noexcept { return from_velocity_; }

  private:
    [[nodiscard]] double trembling() const noexcept;
    [[nodiscard]] double follow(double by_velocity_deg, double by_position_deg) noexcept;

    double gear_ratio_, step_s_;
    Source source_;
    double start_deg_;
    double joint_deg_ = 0.0, step_turns_ = 0.0, last_velocity_ = 0.0, last_position_ = 0.0;
    double ahead_deg_ = 0.0;   ///< of joint_deg_: where the position is
    double beside_ = 0.0;      ///< motor turns by which the position left the velocity in the last sample
    double covariance_ = 0.0;  ///< of that with the sample before, while slow
    double excess_ = 0.0;      ///< mean square of that beyond what a poor clock explains, while slow
    double slow_speed_ = 0.0;  ///< mean motor turns in a sample, while slow
    double judged_ = 0.0;      ///< samples that it is a mean of
    bool started_ = false, from_velocity_ = false;
};

}  // namespace ripplenotch
