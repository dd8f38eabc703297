// SPDX-License-Identifier: MIT
#pragma once
// The declarations of every effect's record, and what the families of effects share; seen by them and by the
// catalogue alone.

#include <algorithm>
#include <array>
#include <complex>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "core/functions/many_numbers.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/model/effect.hpp"

namespace ripplenotch {

namespace effects {

// What the functions of a record are given.
using Values = std::span<const double>;
using Torques = std::span<double>;
using Gains = std::span<std::complex<double>>;

// Rows of the table of an effect's parameters: name, unit, help, numbers.

struct ParameterRange {
    double start, lower, upper, neutral = 0.0;
};

inline Parameter plain(std::string_view name, std::string_view unit, std::string_view help,
                       ParameterRange range) {
    return {.name = name,
            .unit = unit,
            .help = help,
            .neutral = range.neutral,
            .start = range.start,
            .lower = range.lower,
            .upper = range.upper};
}

/// The torque is an affine function of it.
inline Parameter linear(std::string_view name, std::string_view unit, std::string_view help,
                        ParameterRange range) {
    Parameter row = plain(name, unit, help, range);
    row.linear = true;
    return row;
}

/// A search moves in its logarithm.
inline Parameter logarithmic(std::string_view name, std::string_view unit, std::string_view help,
                             ParameterRange range, std::vector<double> tried = {}) {
    Parameter row = plain(name, unit, help, range);
    row.tried = std::move(tried);
    row.logarithmic = true;
    return row;
}

inline Parameter assumed(Parameter row) {
    row.left_out = LeftOut::assumed;
    return row;
}

inline Parameter refused(Parameter row) {
    row.left_out = LeftOut::refused;
    return row;
}

// Parameters that several effects have, with one meaning and one set of bounds.

/// Width of the step that a friction makes at standstill.
inline Parameter width_parameter() {
    return assumed(logarithmic("width_deg_s", "deg/s", "speed at which 76 % of it has built up",
                               {0.2, 0.001, 100.0, 0.2}));
}

/// Cycles per turn, amplitude and phase of a cosine of an angle.
inline Parameter cycles_parameter(std::string_view name, std::string_view help, double start, double upper) {
    return refused(plain(name, "", help, {start, 0.01, upper, start}));
}
inline Parameter cosine_amplitude_parameter() {
    return linear("amplitude_nm", "Nm", "zero to peak", {0.5, 0.0, 1e5});
}
inline Parameter cosine_phase_parameter() {
    return plain("phase_deg", "deg", "phase of the cosine where the position of the joint is zero",
                 {0.0, -360.0, 360.0});
}

/// State of what remembers the last reversal.
inline Parameter initial_state_parameter() {
    return assumed(plain("initial_state", "", "state at the start of the log, -1 to 1", {0.0, -1.0, 1.0}));
}
inline Parameter reversal_width_parameter(std::string_view help) {
    return logarithmic("width_deg", "deg", help, {1.0, 0.001, 1000.0, 1.0});
}

/// Which ripple terms an effect changes.
inline Parameter ripple_order_parameter() {
    return assumed(plain("order", "",
                         "of the ripple that it changes, in cycles per motor revolution; 0 is every order",
                         {0.0, 0.0, 1000.0}));
}
[[nodiscard]] inline bool concerns(Order order, double parameter) {
    return parameter == 0.0 || parameter == order.value();
}

/// Which run of chance; a whole number.
inline constexpr double first_seed = 1.0;
inline Parameter seed_parameter() {
    return assumed(plain("seed", "", "which of the possible logs; its whole part counts",
                         {first_seed, 0.0, 2147483647.0, first_seed}));
}

// Functions of every sample, in blocks that stay in the first-level cache.

inline void cosines_of(std::span<double> angles_deg) { portable::cos_degrees(angles_deg, angles_deg); }
inline void sines_of(std::span<double> angles_deg) { portable::sin_degrees(angles_deg, angles_deg); }

/// use(k, cosine of angle_deg(k)) for each sample k.
template <class AngleDeg, class Use>
void with_cosines(std::size_t samples, AngleDeg angle_deg, Use use) {
    with_values(samples, angle_deg, cosines_of, use);
}

/// use(k, cosine, sine) of angle_deg(k) for each sample k.
template <class AngleDeg, class Use>
void with_cosines_and_sines(std::size_t samples, AngleDeg angle_deg, Use use) {
    with_two_values(samples, angle_deg, cosines_of, angle_deg, sines_of, use);
}

/// use(k, tanh(v / width_deg_s)) for each sample k: the direction of motion, smoothed.
template <class Use>
void with_directions(const Motion& motion, double width_deg_s, Use use) {
    with_values(
        motion.size(), [&](std::size_t k) { return motion.velocity_deg_s[k] / width_deg_s; },
        portable::many_tanh, use);
}

#define EFFECT(name) extern const Effect name;
#include "model/effects/effects.def"
#undef EFFECT
}  // namespace effects

}  // namespace ripplenotch
