// SPDX-License-Identifier: MIT
#pragma once
// Internal to the analysis room: bands with more torque in them than the ripple, beside the lines.

#include <vector>

#include "analysis/lines/conclude.hpp"

namespace ripplenotch {

/// Humps of the stretches and of what the lines leave of the sweeps, those where a line runs left out, and of
/// them those that outdo the strongest line that may turn with the joint. At most three, most torque first.
[[nodiscard]] std::vector<Hum> hums_beside(const Looked& looked, const std::vector<Line>& lines);

}  // namespace ripplenotch
