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
/// Ratios disagree by the same chance, and phases as RecordedPhases says. Empty for fewer than two
/// recordings; `each` and `logs` are of the same ones.
[[nodiscard]] std::vector<Disagreement> disagreements(const Identification& together,
                                                      std::span<const Identification> each,
                                                      std::span<const TraceView> logs);

/// Recordings that agree differ by as much less often than this, where they are told.
inline constexpr double least_chance_of_alike = 0.001;

/// Recordings of which a scatter is told: fewer have no median.
inline constexpr std::size_t fewest_for_scatter = 3;

/// The chance that values which are one differ by as much of their errors.
[[nodiscard]] double chance_of_alike(const std::vector<Disagreement::Value>& values);

/// Speeds, signed, within 5 %.
[[nodiscard]] bool like_speed(double speed_deg_s, double other_deg_s);

}  // namespace ripplenotch
