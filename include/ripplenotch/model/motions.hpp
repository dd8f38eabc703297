// SPDX-License-Identifier: MIT
#pragma once
// Motions for simulate: "constant,speed=60deg/s,duration=5s", "poly6,from=90deg,to=-90deg,duration=2s". A
// kind of motion is a record in src/model/motions.cpp. Pieces follow one another without a jump in position.

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/model/effect.hpp"

namespace ripplenotch {

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
