// SPDX-License-Identifier: MIT
#pragma once
// Internal to the analysis module: consistency of the recordings of one joint.

#include <span>
#include <vector>

#include "analysis/lines/identify.hpp"
#include "ripplenotch/analysis/identification.hpp"

namespace ripplenotch {

// Internal to the analysis module: torque besides the ripple that does not turn with the joint.

// Internal to the analysis module: whether estimates differ by more than their standard errors explain.

/// By what factor errors are too small, when estimates of one value scatter about their weighted mean with
/// `squares` = sum (estimate - mean)^2 / variance on `freedom` degrees of freedom: sqrt(squares / freedom)
/// (Birge 1932), where chance gives such scatter less than once in a hundred times; else 1. An error that is
/// widened by every scatter above the mean one would cover too often, and one that is never widened too
/// seldom.
[[nodiscard]] double excess_scatter(double squares, double freedom);

/// The family that explains most of the tones, or none: three multiples or more of one frequency, up to 12,
/// that match so many tones by chance less than once in 150 cases.
[[nodiscard]] std::vector<ToneFamily> families_among(std::span<const Reported> reported);

/// Notes at tones that they are the mains frequency or a multiple of it: 50 or 60 Hz, whichever accounts for
/// more of the tones of these logs, lower multiples counting more.
void name_mains(std::span<Reported> reported);

/// Humps in the residual of the lines in the sweeps: those that exceed the strongest line that may turn with
/// the joint. At most three, most torque first.
[[nodiscard]] std::vector<Hum> hums_beside(const MotionLines& motion, const std::vector<Line>& lines);

/// Each recording's own result, compared with the lines and the ratio of all of them. Amplitudes are compared
/// at similar speeds only, for ripple depends on speed; they disagree when chance makes as much of their
/// errors less than once in a thousand cases and the largest is a tenth above the smallest or more. Ratios
/// disagree by the same chance; phases, of recordings with a position, where they are 20 deg apart as well,
/// at similar speeds in the same direction: a gear under load may turn the ripple by 0.05 deg of the joint.
/// Empty for fewer than two recordings; `each` and `logs` are of the same recordings.
[[nodiscard]] std::vector<Disagreement> disagreements(const Identification& together,
                                                      std::span<const Identification> each,
                                                      std::span<const TraceView> logs);

}  // namespace ripplenotch
