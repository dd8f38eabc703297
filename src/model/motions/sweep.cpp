// SPDX-License-Identifier: MIT
#include <numbers>

#include "model/motions.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr Key keys[] = {
    swing_amplitude_key("zero to peak, the same at every frequency"),
    swing_frequency_key("from-frequency", "swings per second at its beginning"),
    swing_frequency_key("to-frequency", "swings per second at its end"),
    swing_phase_key("-90deg", "phase of the sine at its beginning; -90deg starts from rest"),
    duration_key,
    from_key,
};

MotionPiece make(const Settings& settings, const std::optional<MotionState>& before) {
    const double from_deg = start_position_deg("sweep", settings, before);
    const double amplitude_deg = settings.number("amplitude");
    const double from_hz = settings.number("from-frequency");
    const double duration_s = settings.number("duration");
    const double rate_hz_s = (settings.number("to-frequency") - from_hz) / duration_s;
    const double phase_deg = settings.number("phase");
    const double center_deg = from_deg - amplitude_deg * portable::sin_degrees(phase_deg);
    return {Seconds(duration_s), [=](Seconds elapsed) {
                const double t = elapsed.value();
                const double angle_deg = 360.0 * (from_hz + 0.5 * rate_hz_s * t) * t + phase_deg;
                const double sine = portable::sin_degrees(angle_deg),
                             cosine = portable::cos_degrees(angle_deg);
                const double rad_s = 2.0 * std::numbers::pi * (from_hz + rate_hz_s * t);
                const double rad_s2 = 2.0 * std::numbers::pi * rate_hz_s;
                return MotionState{center_deg + amplitude_deg * sine, amplitude_deg * rad_s * cosine,
                                   amplitude_deg * (rad_s2 * cosine - rad_s * rad_s * sine)};
            }};
}

}  // namespace

const MotionKind motions::sweep{
    .name = "sweep",
    .summary = "swing back and forth ever faster, or ever slower",
    .equation =
        "q(t) = from + amplitude * (sin(360deg * (f0 t + (f1 - f0) t^2 / (2 duration)) + phase) - "
        "sin(phase)), "
        "f0 = from-frequency, f1 = to-frequency",
    .source = "the linear chirp of system identification, e.g. Ljung, System Identification, 1999",
    .keys = keys,
    .make = make,
};

}  // namespace ripplenotch
