// SPDX-License-Identifier: MIT
#pragma once
// The declarations of every motion kind's record, and what their files share.

#include "ripplenotch/model/motion.hpp"

namespace ripplenotch {

/// Limits of any motion; wide enough for any joint, narrow enough that no product overflows.
inline constexpr double longest_duration_s = 1e6, largest_angle_deg = 1e7, largest_speed_deg_s = 1e5;

/// The keys that every kind has.
inline constexpr Key duration_key = {.name = "duration",
                                     .dimension = Dimension::time,
                                     .required = true,
                                     .above = 0.0,
                                     .at_most = longest_duration_s,
                                     .help = "how long it takes"};
inline constexpr Key from_key = {
    .name = "from",
    .dimension = Dimension::angle,
    .at_least = -largest_angle_deg,
    .at_most = largest_angle_deg,
    .help = "position at its beginning; without it, where the motion before ended, or 0deg"};

/// Keys common to the kinds made of sines, with their meaning there.
constexpr Key swing_amplitude_key(std::string_view help) {
    return {.name = "amplitude",
            .dimension = Dimension::angle,
            .required = true,
            .above = 0.0,
            .at_most = largest_angle_deg,
            .help = help};
}
constexpr Key swing_frequency_key(std::string_view name, std::string_view help) {
    return {.name = name,
            .dimension = Dimension::frequency,
            .required = true,
            .above = 0.0,
            .at_most = 1000.0,
            .help = help};
}
constexpr Key swing_phase_key(std::string_view default_text, std::string_view help) {
    return {.name = "phase",
            .dimension = Dimension::angle,
            .default_text = default_text,
            .at_least = -largest_angle_deg,
            .at_most = largest_angle_deg,
            .help = help};
}

/// Position at which a piece begins. Throws UsageError when `from` contradicts the piece before, naming
/// `kind`.
[[nodiscard]] double start_position_deg(std::string_view kind, const Settings& settings,
                                        const std::optional<MotionState>& before);

namespace motions {
#define MOTION(name) extern const MotionKind name;
#include "model/motions/motions.def"
#undef MOTION
}  // namespace motions

}  // namespace ripplenotch
