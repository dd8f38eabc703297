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

/// From position, jumps of more than half a turn between neighbours taken as wrapping. A position that moves
/// by less than half or more than twice what the velocity says is of something else (a motor encoder, another
/// joint): then, and where there is none, the velocity is integrated. O(n).
[[nodiscard]] OutputAngle output_angle(const TraceView& log);

/// Samples first .. end - 1 of a log.
struct SampleRun {
    std::size_t first = 0, end = 0;
    [[nodiscard]] std::size_t size() const { return end - first; }
};

struct RunRule {
    double slowest_share = 0.02;  ///< of the log's highest speed; slower motion belongs to no run ...
    double slowest_deg_s = 0.2;   ///< ... nor does motion slower than this
    double gap_steps = 10.0;      ///< a step in time of more mean steps than this ends a run
};

/// Velocity as it cuts and weighs: averaged over 0.05 s, far less than any run lasts.
[[nodiscard]] std::vector<double> smoothed_speed(const TraceView& log);

/// Runs of samples that move in one direction without a gap in time, in time order. `speed` is signed, one
/// value a sample. O(n).
[[nodiscard]] std::vector<SampleRun> directed_runs(std::span<const double> time_s,
                                                   std::span<const double> speed_deg_s, Hertz sample_rate,
                                                   const RunRule& rule);

/// Runs of samples without a gap in time, whatever the motion.
[[nodiscard]] std::vector<SampleRun> gapless_runs(std::span<const double> time_s, Hertz sample_rate,
                                                  double gap_steps);

}  // namespace ripplenotch
