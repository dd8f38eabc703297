// SPDX-License-Identifier: MIT
#pragma once
#include <span>
#include <vector>

#include "ripplenotch/analysis/identification.hpp"

namespace ripplenotch {

// Internal to the analysis module: consistency of the recordings of one joint.

/// Each recording's own result, compared with the lines and the ratio of all of them. Amplitudes are compared
/// at similar speeds only, for ripple depends on speed; they disagree when chance makes as much of their
/// errors less than once in a thousand cases and the largest is a tenth above the smallest or more. Ratios
/// disagree by the same chance. Empty for fewer than two recordings.
[[nodiscard]] std::vector<Disagreement> disagreements(const Identification& together,
                                                      std::span<const Identification> each);

}  // namespace ripplenotch
