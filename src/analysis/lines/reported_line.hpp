// SPDX-License-Identifier: MIT
#pragma once
// Internal to the analysis room: lines as identify reports them, from what the motion shows.

#include <cstddef>
#include <optional>
#include <span>

#include "ripplenotch/analysis/gear_ratio.hpp"
#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/analysis/motion_lines.hpp"

namespace ripplenotch {

/// A line as it is reported, and as the gear ratio sees it when it may turn with the joint.
struct Reported {
    Line line = {};
    std::optional<OrderLine> order = {};
    double hz_error = 0.0;  ///< of line.hz
};

/// Line number `source` of a motion; folds are told with the rate of the samples.
[[nodiscard]] Reported from_motion(const MotionLines& motion, std::size_t source,
                                   const IdentifyOptions& options, double rate_hz);

/// Notes at tones that they are the mains frequency or a multiple of it: 50 or 60 Hz, whichever accounts for
/// more of the tones of these logs, lower multiples counting more.
void name_mains(std::span<Reported> reported);

}  // namespace ripplenotch
