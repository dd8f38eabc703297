// SPDX-License-Identifier: MIT
#pragma once
// Internal to the analysis room: what stands in the torque beside the ripple, and does not turn with the
// joint.

#include <span>
#include <vector>

#include "analysis/lines/identify.hpp"

namespace ripplenotch {

// Internal to the analysis room: whether estimates disagree by more than their errors say.

/// By what factor errors are too small, when estimates of one value scatter about their weighted mean with
/// `squares` = sum (estimate - mean)^2 / variance on `freedom` degrees of freedom: sqrt(squares / freedom)
/// (Birge 1932), where chance gives such scatter less than once in a hundred times; else 1. An error that is
/// widened by every scatter above the mean one would cover too often, and one that is never widened too
/// seldom.
[[nodiscard]] double excess_scatter(double squares, double freedom);

/// The family that explains most of the tones, or none: three multiples or more of one frequency, up to 12,
/// that meet so many tones by chance less than once in 150 cases.
[[nodiscard]] std::vector<ToneFamily> families_among(std::span<const Reported> reported);

/// Notes at tones that they are the mains frequency or a multiple of it: 50 or 60 Hz, whichever accounts for
/// more of the tones of these logs, lower multiples counting more.
void name_mains(std::span<Reported> reported);

/// Humps of what the lines leave of the sweeps: those that outdo the strongest line that may turn with the
/// joint. At most three, most torque first.
[[nodiscard]] std::vector<Hum> hums_beside(const MotionLines& motion, const std::vector<Line>& lines);

}  // namespace ripplenotch
