// SPDX-License-Identifier: MIT
#pragma once
// Keys that every method has that follows the gear: where the ripple is.

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/core/spec.hpp"

namespace ripplenotch {

// The angle by which ripple is followed, from the columns of a log: position, else the integrated velocity.

/// Receives samples in order. From the position where there is one, which is the joint's then (unwrapped at
/// half turns of the joint); else from the velocity by trapezoids. While the motor turns slowly, a position
/// that is noisy about the velocity is smoothed: with ripple tied to the angle, a noisy angle under a steady
/// torque would drive its estimate to zero.
class MotorAngle {
  public:
    enum class Source : std::uint8_t { best, velocity };

    /// `start_deg` is the joint's position at the first sample where the log has no position.
    MotorAngle(double gear_ratio, double sample_rate_hz, Source source, double start_deg) noexcept
        : gear_ratio_(gear_ratio), step_s_(1.0 / sample_rate_hz), source_(source), start_deg_(start_deg) {}

    void restart() noexcept;
    /// `position_deg` may be null. `correction_deg_s` is added to the velocity, where that is what counts.
    void next(double velocity_deg_s, const double* position_deg, double correction_deg_s = 0.0) noexcept;

    [[nodiscard]] double turns() const noexcept {
        return gear_ratio_ * joint_deg_ / 360.0;
    }                                                                         ///< turns of the motor
    [[nodiscard]] double step_turns() const noexcept { return step_turns_; }  ///< since the sample before
    [[nodiscard]] bool from_velocity() const noexcept { return from_velocity_; }

  private:
    [[nodiscard]] double trembling() const noexcept;
    [[nodiscard]] double follow(double by_velocity_deg, double by_position_deg) noexcept;

    double gear_ratio_, step_s_;
    Source source_;
    double start_deg_;
    double joint_deg_ = 0.0, step_turns_ = 0.0, last_velocity_ = 0.0, last_position_ = 0.0;
    double ahead_deg_ = 0.0;   ///< lead of the measured position over joint_deg_
    double beside_ = 0.0;      ///< motor turns by which the position left the velocity in the last sample
    double covariance_ = 0.0;  ///< covariance of that with the sample before, while slow
    double excess_ = 0.0;      ///< mean square of that beyond what a poor clock explains, while slow
    double slow_speed_ = 0.0;  ///< mean motor turns in a sample, while slow
    double judged_ = 0.0;      ///< samples that it is a mean of
    bool started_ = false, from_velocity_ = false;
};

inline constexpr Key gear_ratio_key{
    .name = "gear-ratio",
    .above = 0.0,
    .at_most = 1e5,
    .help = "motor turns per joint turn, for orders by the motor; or joint=joint.json"};
inline constexpr Key orders_key{
    .name = "orders",
    .kind = KeyKind::text,
    .required = true,
    .help =
        "ripple lines in cycles per motor turn, 1:2, or per turn of the joint, 100/turn:200/turn; or "
        "joint=joint.json"};
/// Never reaches a method: the code that loads files replaces it by the keys that it abbreviates.
inline constexpr Key joint_key{.name = "joint",
                               .kind = KeyKind::text,
                               .help =
                                   "joint.json of identify: gear ratio, orders and what else the method "
                                   "has keys for, unless given"};

inline constexpr Key angle_key{
    .name = "angle",
    .default_text = "best",
    .choices = "best velocity",
    .help = "best: position, velocity where there is none or it is not the joint's; velocity: always that"};
[[nodiscard]] MotorAngle::Source angle_source(const Settings& settings);

struct RippleOrders {
    double gear_ratio = 0.0;     ///< turns per turn of the joint of the shaft by which they count
    std::vector<double> orders;  ///< in the sequence as given, each once

    /// The lowest, which is a multiple of 1 by the motor.
    [[nodiscard]] double lowest() const { return *std::min_element(orders.begin(), orders.end()); }
    /// The same lines as multiples of the lowest, under as many turns per turn of the joint. What counts by
    /// turns of that is the same whatever ratio names the lines.
    [[nodiscard]] RippleOrders by_lowest() const;
    /// The same lines by turns of the joint.
    [[nodiscard]] RippleOrders by_joint() const;
};

/// By the motor under its ratio, by the joint without one. Throws UsageError when an order is given twice,
/// and what orders_under throws.
[[nodiscard]] RippleOrders ripple_orders(std::string_view method, const Settings& settings);

/// A list with one value per order, `otherwise` for each when the key is not given. Throws UsageError when it
/// has another length.
[[nodiscard]] std::vector<double> per_order(std::string_view method, const Settings& settings,
                                            std::string_view key, const RippleOrders& orders,
                                            double otherwise);

}  // namespace ripplenotch
