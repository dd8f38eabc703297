// SPDX-License-Identifier: MIT
#pragma once
// What a second log must have to separate the effects that the motion of this one left: one sentence, for
// every command that says it.

#include <span>
#include <string>
#include <string_view>

namespace ripplenotch {

/// Shares of the samples, by velocity; what is slow moves as well.
struct MotionSeen {
    double positive = 0.0, negative = 0.0, rest = 0.0, slowly = 0.0;
};
/// Velocities that are no number are left out.
[[nodiscard]] MotionSeen motion_seen(std::span<const double> velocity);

/// What decides between the effects in question: the direction of motion and rests (offset or friction), the
/// speed (kinds of friction), the position, the load.
struct MotionAsked {
    bool direction = false, speed = false, position = false, load = false;
    double travel_deg = 0.0;  ///< of this log
    bool has_position = true;
};

/// "a second log with rests of 1 s and another load would separate offset, load-friction": at most 30 words;
/// empty where this log has all of it. No `rivals`: those that the motion of this log leaves.
[[nodiscard]] std::string second_log(const MotionSeen& seen, const MotionAsked& asked,
                                     std::span<const std::string_view> rivals = {});

}  // namespace ripplenotch
