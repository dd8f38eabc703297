// SPDX-License-Identifier: MIT
#pragma once
// The motion of a log, as a model is evaluated along it.

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/model/effect.hpp"

namespace ripplenotch {

/// 1 % off in speed at 8 Hz, 2 % in acceleration (docs/commands/simulate.md).
inline constexpr Seconds default_smoothing{0.05};

/// The motion that the log measured, at the log's own times. Nothing in it is ahead of or behind the log:
/// * velocity and acceleration are value and slope of the cubic that fits the logged velocity best, by least
///   squares, within half of `smoothing` to both sides (Savitzky and Golay, 1964, on times as they are). A
///   component of frequency f keeps its velocity within 1 % and its acceleration within 2 % as long as
///   f * smoothing < 0.4; within smoothing / 2 of the ends the cubic leans to one side. Below 5 samples the
///   5 nearest are taken, so that a smoothing of 0 keeps as much as can be differentiated.
/// * a logged position is fitted with the velocity, as its integral, each sample weighted by the noise
///   estimated from its fourth differences, as long as the two show the same motion: a fifth of the
///   differences between the two speeds may exceed 1.5 times the value expected from noise. Otherwise the
///   velocity is used alone.
/// * where the speed cannot be distinguished from zero (4.5 standard deviations of its noise, two encoder
///   steps a window, 0.5 deg/s at most) for three smoothing windows or more, the joint is at standstill:
///   speed and acceleration are 0 there.
/// * position is the log's, or else the integral of the logged velocity by the trapezoidal rule, from 0,
///   which gives a component of frequency f too small by (2 pi f / sample_rate)^2 / 12 of it.
/// Throws DataError: fewer than 5 samples, or times that do not increase.
[[nodiscard]] Motion motion_along(const TraceView& log, Seconds smoothing = default_smoothing);

// Motions for simulate: "constant,speed=60deg/s,duration=5s", "poly6,from=90deg,to=-90deg,duration=2s". A
// kind of motion is a record in src/model/motions.cpp. Pieces follow one another without a jump in position.

/// Where the joint is at one moment, and how it moves.
struct MotionState {
    double position_deg = 0.0, velocity_deg_s = 0.0, acceleration_deg_s2 = 0.0;
};

/// A piece of motion in continuous time. `at` is defined for 0 <= elapsed <= duration.
struct MotionPiece {
    Seconds duration;
    std::function<MotionState(Seconds elapsed)> at;
};

struct MotionKind {
    std::string_view name;      ///< as in a specification
    std::string_view summary;   ///< one line
    std::string_view equation;  ///< position against elapsed time t
    std::string_view source;
    std::vector<Key> keys;
    /// `before` is the state in which the piece before ended; empty for the first piece. Throws UsageError.
    MotionPiece (*make)(const Settings& settings, const std::optional<MotionState>& before) = nullptr;
};

/// All kinds in the order of the help.
[[nodiscard]] std::span<const MotionKind* const> motion_kinds();

/// Throws UsageError with the nearest name.
[[nodiscard]] const MotionKind& find_motion_kind(std::string_view name);

/// Longest motion that make_motion samples; a request beyond it is a UsageError.
inline constexpr std::size_t most_samples = 100'000'000;

/// Samples the pieces one after another. Sample k is at k / sample_rate, computed afresh for each k so that
/// time does not drift; the motion covers [0, sum of durations), so that 5 s at 1 kHz are 5000 samples. A
/// piece begins at its own start time even when that falls between two samples. Throws UsageError.
[[nodiscard]] Motion make_motion(std::span<const std::string> specs, Hertz sample_rate);
[[nodiscard]] Motion make_motion(std::string_view spec, Hertz sample_rate);

}  // namespace ripplenotch
