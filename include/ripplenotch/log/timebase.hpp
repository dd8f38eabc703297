// SPDX-License-Identifier: MIT
#pragma once
// The clock of a log: what its rate really is, where it stumbles, and whether it agrees with the motion.

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/core/units.hpp"

namespace ripplenotch {

/// A step longer than the gap limit: samples `row` and `row + 1` belong to different runs.
struct Gap {
    std::size_t row = 0;  ///< last row before the gap, 0-based
    double from_s = 0.0, to_s = 0.0;
};

struct Timebase {
    Hertz sample_rate;  ///< (rows - 1) / duration, gaps left out: not 1 / median step
    Seconds median_step;
    Seconds shortest_step, longest_step;
    Seconds jitter;  ///< rms deviation of the steps from their mean, gaps left out
    std::vector<Gap> gaps;
    std::size_t repeated_times = 0;  ///< steps of exactly zero
    std::size_t held_samples = 0;    ///< torque samples equal to the one before, while the joint moves
    std::size_t longest_hold = 0;    ///< rows
    /// Change of position divided by integrated velocity, by robust regression over the log; 1 when the
    /// clock, the velocity unit and the position unit agree. Empty without position or without motion.
    std::optional<double> clock_factor;
    std::vector<std::string> warnings;  ///< one sentence each, naming factors
};

/// A gap is a step of more than `gap_steps` median steps.
inline constexpr double default_gap_steps = 10.0;

/// `stated_rate` is from --sample-rate; then times are already uniform and only held samples and the clock
/// are checked.
[[nodiscard]] Timebase examine_timebase(const TraceView& trace, double gap_steps = default_gap_steps);

/// Of that the steps alone: rate, steps, jitter, gaps and repeated times, and no warnings.
[[nodiscard]] Timebase examine_steps(std::span<const double> time_s, double gap_steps = default_gap_steps);

}  // namespace ripplenotch
