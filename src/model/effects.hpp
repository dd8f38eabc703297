// SPDX-License-Identifier: MIT
#pragma once
// The declarations of every effect's record, and what their files share; seen by the effects' own files and
// by the catalogue alone.

#include "ripplenotch/model/effect.hpp"

namespace ripplenotch {

// Parameters that several effects have, with one meaning and one set of bounds.

/// Width of the step that a friction makes at standstill.
inline constexpr Parameter width_parameter = {.name = "width_deg_s",
                                              .unit = "deg/s",
                                              .help = "speed at which 76 % of it has built up",
                                              .neutral = 0.2,
                                              .start = 0.2,
                                              .lower = 0.001,
                                              .upper = 100.0,
                                              .logarithmic = true,
                                              .left_out = LeftOut::assumed};

/// Cycles per turn and phase of a cosine of an angle; a screening begins at `tried`.
constexpr Parameter cycles_parameter(std::string_view name, std::string_view help, double start, double upper,
                                     std::span<const double> tried) {
    return {.name = name,
            .unit = "",
            .help = help,
            .neutral = start,
            .start = start,
            .lower = 0.01,
            .upper = upper,
            .left_out = LeftOut::refused,
            .tried = tried};
}
inline constexpr Parameter cosine_amplitude_parameter = {
    .name = "amplitude_nm", .unit = "Nm", .help = "zero to peak", .start = 0.5, .upper = 1e5, .linear = true};
inline constexpr Parameter cosine_phase_parameter = {
    .name = "phase_deg",
    .unit = "deg",
    .help = "phase of the cosine where the position of the joint is zero",
    .lower = -360.0,
    .upper = 360.0};

/// State of what remembers the last reversal.
inline constexpr Parameter initial_state_parameter = {.name = "initial_state",
                                                      .unit = "",
                                                      .help = "state at the start of the log, -1 to 1",
                                                      .lower = -1.0,
                                                      .upper = 1.0,
                                                      .left_out = LeftOut::assumed};
constexpr Parameter reversal_width_parameter(std::string_view help, std::span<const double> tried) {
    return {.name = "width_deg",
            .unit = "deg",
            .help = help,
            .neutral = 1.0,
            .start = 1.0,
            .lower = 0.001,
            .upper = 1000.0,
            .logarithmic = true,
            .tried = tried};
}

/// Which ripple terms an effect changes.
inline constexpr Parameter ripple_order_parameter = {
    .name = "order",
    .unit = "",
    .help = "of the ripple that it changes, in cycles per motor revolution; 0 is every order",
    .upper = 1000.0,
    .left_out = LeftOut::assumed,
    .hint = Hint::ripple_orders};
[[nodiscard]] inline bool concerns(Order order, double parameter) {
    return parameter == 0.0 || parameter == order.value();
}

/// Which run of chance; a whole number.
inline constexpr Parameter seed_parameter = {.name = "seed",
                                             .unit = "",
                                             .help = "which of the possible logs; its whole part counts",
                                             .neutral = 1.0,
                                             .start = 1.0,
                                             .upper = 2147483647.0,
                                             .left_out = LeftOut::assumed};

namespace effects {
#define EFFECT(name) extern const Effect name;
#include "model/effects/effects.def"
#undef EFFECT
}  // namespace effects

}  // namespace ripplenotch
