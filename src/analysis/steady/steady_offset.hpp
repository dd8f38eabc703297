// SPDX-License-Identifier: MIT
#pragma once
// Internal to the analysis room: what the velocity of logs without position is off by, told by lines of
// steady stretches.

#include <optional>
#include <span>
#include <vector>

#include "ripplenotch/analysis/steady_lines.hpp"

namespace ripplenotch {

/// How far what the sightings of `lines` still say of an offset is from none: a velocity v with the offset d
/// puts ripple of order k at k (v - d) / 360, so that the order that is seen is ln k - d/v in its logarithm.
/// Generalised least squares of all lines of kind order, where lines of one stretch share the error of its
/// speed. The error is widened by what the stretches scatter more than theirs. Empty where the speeds of
/// these lines do not tell it.
[[nodiscard]] std::optional<SteadyOffset> steady_offset(std::span<const SteadyLine> lines, DegPerSec likely);

/// Speeds less than three times the offset stay as they are: what turns there is not known.
void take_off(DegPerSec offset, std::vector<Sighting>& sightings);

}  // namespace ripplenotch
