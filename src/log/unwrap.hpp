// SPDX-License-Identifier: MIT
#pragma once
// Angles that start again at a full turn, made continuous.

#include <optional>
#include <span>

namespace ripplenotch {

/// The period at which an angle jumps back: 360 deg, or what a full turn becomes when the unit is mistaken (2
/// pi, 360 * 180 / pi). Empty when nothing jumps, or when jumps are no full turn.
[[nodiscard]] std::optional<double> wrap_period(std::span<const double> position_deg);

/// Removes jumps of whole periods in place.
void unwrap(std::span<double> position_deg, double period);

}  // namespace ripplenotch
