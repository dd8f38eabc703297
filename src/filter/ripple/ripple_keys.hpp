// SPDX-License-Identifier: MIT
#pragma once
// Keys that every method has that follows the gear: where the ripple is.

#include <array>
#include <string_view>
#include <vector>

#include "filter/ripple/motor_angle.hpp"
#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/core/units.hpp"

namespace ripplenotch {

inline constexpr Key gear_ratio_key{.name = "gear-ratio",
                                    .required = true,
                                    .above = 0.0,
                                    .at_most = 1e5,
                                    .help = "motor turns per joint turn; or joint=joint.json"};
inline constexpr Key orders_key{
    .name = "orders",
    .kind = KeyKind::list,
    .required = true,
    .above = 0.0,
    .at_most = 1e4,
    .help = "ripple lines in cycles per motor turn, e.g. 1:2; or joint=joint.json"};
/// Never seen by a method: whoever loads files replaces it by the keys that it stands for.
inline constexpr Key joint_key{.name = "joint",
                               .kind = KeyKind::text,
                               .help =
                                   "joint.json of identify: gear ratio, orders and what else the method "
                                   "has keys for, unless given"};

inline constexpr std::array<std::string_view, 2> angle_choices = {"best", "velocity"};
inline constexpr Key angle_key{
    .name = "angle",
    .kind = KeyKind::choice,
    .default_text = "best",
    .choices = angle_choices,
    .help = "best: position, velocity where there is none or it is not the joint's; velocity: always that"};
[[nodiscard]] MotorAngle::Source angle_source(const Settings& settings);

struct RippleOrders {
    double gear_ratio = 0.0;
    std::vector<double> orders;  ///< as given, each once

    /// Frequency of a line in Hz at a joint speed in deg/s.
    [[nodiscard]] double hz(std::size_t line, double speed_deg_s) const noexcept;
};

/// Throws UsageError when an order is given twice.
[[nodiscard]] RippleOrders ripple_orders(std::string_view method, const Settings& settings);

/// A list with one value per order, `otherwise` for each when the key is not given. Throws UsageError when it
/// has another length.
[[nodiscard]] std::vector<double> per_order(std::string_view method, const Settings& settings,
                                            std::string_view key, const RippleOrders& orders,
                                            double otherwise);

}  // namespace ripplenotch
