// SPDX-License-Identifier: MIT
#pragma once
// Internal to the analysis room: do recordings of one joint tell the same?

#include <span>
#include <vector>

#include "ripplenotch/analysis/identification.hpp"

namespace ripplenotch {

/// What each recording says by itself, held against the lines and the ratio of all of them. Amplitudes are
/// compared at like speeds only, for ripple depends on speed; they disagree when chance makes as much of
/// their errors less than once in a thousand cases and the largest is a tenth above the smallest or more.
/// Ratios disagree by the same chance; phases, of recordings with a position, where they are 20 deg apart as
/// well, at like speeds in the same direction: a gear under load may turn the ripple by 0.05 deg of the
/// joint. Empty for fewer than two recordings; `each` and `logs` are of the same ones.
[[nodiscard]] std::vector<Disagreement> disagreements(const Identification& together,
                                                      std::span<const Identification> each,
                                                      std::span<const TraceView> logs);

}  // namespace ripplenotch
