// SPDX-License-Identifier: MIT
#pragma once
// The one account of a recording: what every command says of the log it read.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/log/clock.hpp"
#include "ripplenotch/log/layout.hpp"

namespace ripplenotch {

// Is the position column this joint's? Asked once, where a log is read; all that follows takes the answer.

/// Where the joint's angle comes from, and why.
struct AngleFacts {
    struct Parting {
        std::size_t row = 0;       ///< of the log, 0-based
        std::size_t used_row = 0;  ///< of the rows that are used
    };
    enum class Source { position, velocity };
    enum class Verdict {
        no_position,
        no_velocity,        ///< that could be held against the position
        too_little_motion,  ///< to tell: the position is believed
        agrees,
        reversed,   ///< agrees with its sign turned
        stands,     ///< while the velocity says that the joint moves: it does not
        scaled,     ///< follows the velocity, less than half or more than twice as far
        unrelated,  ///< does not follow the velocity
    };
    Verdict verdict = Verdict::no_position;
    std::optional<double> factor;  ///< position over velocity and time, where it is steady
    /// Where position and velocity part on the way: from here on the angle goes by the velocity.
    std::optional<Parting> contradicted;

    [[nodiscard]] Source source() const;
    /// One clause.
    [[nodiscard]] std::string reason() const;
    /// A sentence where the position is not taken as it stands, or the log contradicts itself later; or
    /// empty.
    [[nodiscard]] std::string warning() const;
};
[[nodiscard]] std::string_view source_name(AngleFacts::Source source);

/// Rows that repeat the row before because nothing new had been measured.
struct HeldSamples {
    std::size_t count = 0;
    std::size_t longest = 0;  ///< rows in the longest unbroken repetition
    std::size_t moving = 0;   ///< rows that could have repeated the row before: the joint moves
};

/// What is held of a log that is too long to be held: evenly spread pieces of its rows.
struct LookedAt {
    std::size_t rows = 0, pieces = 0;
};

struct Recording {
    std::string source, joint;       ///< joint: empty for a log of one unnamed joint
    std::string torque_unit = "Nm";  ///< "A" where a motor current stands for the torque (Column::current)
    ClockFacts clock;
    HeldSamples held;
    AngleFacts angle;
    std::vector<Assumption> assumptions, inferences;  ///< as in Layout
    std::optional<RowsOutside> outside;               ///< where a range was asked for
    std::optional<LookedAt> looked_at;                ///< where only part of the rows was held
    std::vector<LogWarning> warnings;                 ///< about clock, held samples and angle

    [[nodiscard]] std::size_t rows() const { return clock.rows; }
    /// How often the signals are measured: the nominal rate of the rows, unless most of them repeat the row
    /// before. A filter runs row by row, at the nominal rate; what it can be designed for ends at half of
    /// this one.
    [[nodiscard]] Hertz update_rate() const;
};

/// The warnings of what is known; `clock_check` is what comparing the clock with the motion gave, if it did.
[[nodiscard]] std::vector<LogWarning> recording_warnings(const Recording& recording,
                                                         const std::string& clock_check = {});

}  // namespace ripplenotch
