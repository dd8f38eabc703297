// SPDX-License-Identifier: MIT
#pragma once
// The motion of a log, as a model is evaluated along it.

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

}  // namespace ripplenotch
