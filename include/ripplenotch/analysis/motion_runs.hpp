// SPDX-License-Identifier: MIT
#pragma once
// The motion behind a log: the angle of its output shaft, and the stretches in which it turns one way.

#include <cstddef>
#include <span>
#include <vector>

#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {

/// Output angle in turns, one value a sample, without jumps.
struct OutputAngle {
    std::vector<double> turns;
    bool absolute = false;  ///< counted from the zero of the joint's position; else from the first sample
};

/// From the position, which is the joint's where there is one, jumps of more than half a turn between
/// neighbours taken as wrapping; else the velocity is integrated. O(n).
[[nodiscard]] OutputAngle output_angle(const TraceView& log);

/// Samples first .. end - 1 of a log.
struct SampleRun {
    std::size_t first = 0, end = 0;
    [[nodiscard]] std::size_t size() const { return end - first; }
};

struct RunRule {
    double slowest_share = 0.02;    ///< of the log's highest speed; slower motion belongs to no run
    double standstill_deg_s = 0.0;  ///< nor does this
};

/// Velocity as it cuts and weighs: averaged over 0.05 s, far less than any run lasts.
[[nodiscard]] std::vector<double> smoothed_speed(const TraceView& log);

/// Runs of samples that move in one direction, in time order, none across a row of `run_starts`
/// (TraceView). `speed` is signed, one value a sample. O(n).
[[nodiscard]] std::vector<SampleRun> directed_runs(std::span<const double> speed_deg_s,
                                                   std::span<const std::size_t> run_starts,
                                                   const RunRule& rule);

/// Runs of so many samples, whatever the motion.
[[nodiscard]] std::vector<SampleRun> whole_runs(std::size_t samples, std::span<const std::size_t> run_starts);

}  // namespace ripplenotch
