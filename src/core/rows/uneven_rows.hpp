// SPDX-License-Identifier: MIT
#pragma once
// Series whose times are not regular.

#include <span>
#include <vector>

namespace ripplenotch {

/// The median of the steps between times.
[[nodiscard]] double usual_step_s(std::span<const double> time_s);

/// Values at rising places, linear between known ones; constant beyond the ends. `known` rises, equal places
/// are allowed.
[[nodiscard]] std::vector<double> interpolate(std::span<const double> known, std::span<const double> values,
                                              std::span<const double> places);

}  // namespace ripplenotch
