// SPDX-License-Identifier: MIT
#include <numbers>

#include "model/motions.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr Key keys[] = {
    swing_amplitude_key("zero to peak"),
    swing_frequency_key("frequency", "swings per second"),
    swing_phase_key("-90deg", "phase of the sine at its beginning; -90deg starts from rest"),
    duration_key,
    from_key,
};

MotionPiece make(const Settings& settings, const std::optional<MotionState>& before) {
    const double from_deg = start_position_deg("sine", settings, before);
    const double amplitude_deg = settings.number("amplitude");
    const double frequency_hz = settings.number("frequency");
    const double phase_deg = settings.number("phase");
    const double center_deg = from_deg - amplitude_deg * portable::sin_degrees(phase_deg);
    const double rad_s = 2.0 * std::numbers::pi * frequency_hz;
    return {Seconds(settings.number("duration")), [=](Seconds elapsed) {
                const double angle_deg = 360.0 * frequency_hz * elapsed.value() + phase_deg;
                const double sine = portable::sin_degrees(angle_deg),
                             cosine = portable::cos_degrees(angle_deg);
                return MotionState{center_deg + amplitude_deg * sine, amplitude_deg * rad_s * cosine,
                                   -amplitude_deg * rad_s * rad_s * sine};
            }};
}

}  // namespace

const MotionKind motions::sine{
    .name = "sine",
    .summary = "swing back and forth",
    .equation = "q(t) = from + amplitude * (sin(360deg * frequency * t + phase) - sin(phase))",
    .source =
        "the usual excitation for friction and reversal, e.g. Olsson et al., European Journal of Control 4, "
        "1998",
    .keys = keys,
    .make = make,
};

}  // namespace ripplenotch
