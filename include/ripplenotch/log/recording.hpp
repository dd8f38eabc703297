// SPDX-License-Identifier: MIT
#pragma once
// The one account of a recording: what every command says of the log it read.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "ripplenotch/log/clock.hpp"
#include "ripplenotch/log/joint_angle.hpp"
#include "ripplenotch/log/layout.hpp"

namespace ripplenotch {

/// Rows that repeat the row before because nothing new had been measured.
struct HeldSamples {
    std::size_t count = 0;
    std::size_t longest = 0;  ///< rows in the longest unbroken repetition
};

/// What is held of a log that is too long to be held: evenly spread pieces of its rows.
struct LookedAt {
    std::size_t rows = 0, pieces = 0;
};

struct Recording {
    std::string source, joint;  ///< joint: empty for a log of one unnamed joint
    ClockFacts clock;
    HeldSamples held;
    AngleFacts angle;
    std::vector<Assumption> assumptions, inferences;  ///< as in Layout
    std::optional<RowsOutside> outside;               ///< where a range was asked for
    std::optional<LookedAt> looked_at;                ///< where only part of the rows was held
    std::vector<LogWarning> warnings;                 ///< about clock, held samples and angle

    [[nodiscard]] std::size_t rows() const { return clock.rows; }
};

/// The warnings of what is known; `clock_check` is what comparing the clock with the motion gave, if it did.
[[nodiscard]] std::vector<LogWarning> recording_warnings(const Recording& recording,
                                                         const std::string& clock_check = {});

}  // namespace ripplenotch
