// SPDX-License-Identifier: MIT
#pragma once
// Motion cut into sweeps of one direction, each ready for Fourier sums over angle or over time.

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {

/// Offset of the logged velocity, with its standard error.
struct VelocityError {
    DegPerSec offset, offset_error;
};

/// Standard deviation of the velocity's noise, row by row, while the joint moves: what makes a supervisor
/// switch back and forth at the edge of a band. From third differences of rows 10 ms apart, of which motion
/// of some hertz adds little. Steps of an encoder count as noise. 0 for a log of fewer than a hundred such
/// rows.
[[nodiscard]] DegPerSec velocity_noise(const TraceView& log);

// The motion behind a log: the angle of its output shaft, and the stretches in which it turns one way.

/// Output angle in turns, one value a sample, without jumps.
struct OutputAngle {
    std::vector<double> turns;
    bool absolute = false;    ///< counted from the zero of the joint's position; else from the first sample
    double step_turns = 0.0;  ///< of a coarse encoder, between whose steps the angle is smooth; 0: none
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
    double slowest_share = 0.02;    ///< share of the log's highest speed; slower motion belongs to no run
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

struct SweepRule {
    /// Longer sweeps are cut into half-overlapping pieces of this length: the four cycles that a line once a
    /// turn needs. The families of both splines, one order apart, are two lines then.
    double longest_turns = 4.0;
    double longest_s = 20.0;       ///< ... and of at most this duration
    double shortest_turns = 0.02;  ///< chosen, not derived
    /// Chosen, not derived: a line of four cycles and four neighbouring cells.
    std::size_t fewest_samples = 24;
    double slowest_share = 0.02;  ///< share of the log's highest speed; slower motion belongs to no sweep
    std::size_t most_samples =
        300000;                     ///< with more, evenly chosen pieces are used, so that the cost is bounded
    std::size_t most_pieces = 100;  ///< the same
};

/// One piece of motion, or of standstill, which has no length in angle and is seen over time alone. The
/// vectors have the same length.
struct Sweep {
    std::size_t log = 0, first = 0;       ///< where its first sample stands
    std::vector<double> turns;            ///< output angle in turns; absolute where the log has a position
    std::vector<double> time_s;           ///< from the piece's middle
    std::span<const double> measured_nm;  ///< as the log has it, and as long as the log is there
    std::vector<double> torque_nm;        ///< less its smooth part and lines: of who takes these off
    std::vector<double> speed_deg_s;      ///< signed, smoothed
    std::vector<double> value;            ///< the same times the weight, in Nm turns
    /// Hann window in angle times the angle that the sample stands for; at standstill in time.
    std::vector<double> weight;
    std::vector<double> share_turns;  ///< angle that a sample stands for; at standstill seconds
    double weight_sum = 0.0, weight_square_sum = 0.0;
    double length_turns = 0.0;
    double duration_s = 0.0;
    double slow_deg_s = 0.0, quick_deg_s = 0.0;  ///< lower and upper quartile of |speed| under the weight
    double fast_deg_s = 0.0;                     ///< highest |speed|
    double mean_deg_s = 0.0;                     ///< signed mean speed under the weight
    double rate_hz = 0.0;

    /// Equivalent number of samples of equal weight: (sum w)^2 / sum w^2.
    [[nodiscard]] double effective_samples() const { return weight_sum * weight_sum / weight_square_sum; }
    [[nodiscard]] bool rest() const { return !(length_turns > 0.0); }
    /// From 0 to 1 along the piece, in angle, or in time at standstill.
    [[nodiscard]] double progress(std::size_t k) const {
        return rest() ? (time_s[k] - time_s.front()) / duration_s
                      : std::abs(turns[k] - turns.front()) / length_turns;
    }
};

struct Sweeps {
    std::vector<Sweep> pieces;
    std::size_t pieces_left_out = 0;  ///< because of SweepRule::most_samples or most_pieces
    bool absolute_angle = true;       ///< all logs have a position
};

enum class Axis {
    angle,  ///< places are output orders: cycles per output turn
    time,   ///< places are hertz
};
/// The places of a sweep's samples on an axis: output turns, or seconds from its middle.
[[nodiscard]] inline std::span<const double> places(const Sweep& sweep, Axis axis) {
    return axis == Axis::angle ? sweep.turns : sweep.time_s;
}
/// Length of a sweep on an axis: turns or seconds.
[[nodiscard]] inline double length_of(const Sweep& sweep, Axis axis) {
    return axis == Axis::angle ? sweep.length_turns : sweep.duration_s;
}

/// A part of a sweep with a Hann window of its own; for asking whether a line is there in each half.
[[nodiscard]] Sweep part_of(const Sweep& sweep, std::size_t first, std::size_t count);

/// Angle from position (unwrapped at 360 deg) where there is one, else from integrated velocity, whose drift
/// does not matter within one sweep. Where there is no position, the velocity is corrected by `error`. O(n).
[[nodiscard]] Sweeps cut_sweeps(std::span<const TraceView> logs, const SweepRule& rule,
                                const VelocityError& error = {});

}  // namespace ripplenotch
