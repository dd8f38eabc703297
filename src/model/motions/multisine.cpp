// SPDX-License-Identifier: MIT
#include <cmath>
#include <numbers>
#include <vector>

#include "model/motions.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr Key keys[] = {
    swing_amplitude_key("sum of the amplitudes of the sines; the joint stays within it"),
    swing_frequency_key("frequency", "swings per second of the slowest sine; the others are its multiples"),
    {.name = "count",
     .default_text = "5",
     .above = 0.0,
     .at_most = 1000.0,
     .whole = true,
     .help = "number of sines, a whole number"},
    swing_phase_key("0deg", "added to the phase of every sine; 180deg turns the motion round"),
    duration_key,
    from_key,
};

struct Sine {
    double amplitude_deg, frequency_hz, phase_deg;
};

// Amplitudes in proportion to 1 / k, so that each sine has the same peak speed; Schroeder's phases keep their
// peaks apart.
std::vector<Sine> make_sines(const Settings& settings) {
    const double count = settings.number("count");
    double sum = 0.0;
    for (double k = 1.0; k <= count; ++k) sum += 1.0 / k;
    std::vector<Sine> sines;
    for (double k = 1.0; k <= count; ++k) {
        sines.push_back({settings.number("amplitude") / (k * sum), k * settings.number("frequency"),
                         settings.number("phase") - 180.0 * k * (k - 1.0) / count});
    }
    return sines;
}

MotionPiece make(const Settings& settings, const std::optional<MotionState>& before) {
    const auto sines = make_sines(settings);
    double center_deg = start_position_deg("multisine", settings, before);
    for (const Sine& sine : sines) center_deg -= sine.amplitude_deg * portable::sin_degrees(sine.phase_deg);
    return {Seconds(settings.number("duration")), [=](Seconds elapsed) {
                MotionState state{.position_deg = center_deg};
                for (const Sine& sine : sines) {
                    const double angle_deg = 360.0 * sine.frequency_hz * elapsed.value() + sine.phase_deg;
                    const double rad_s = 2.0 * std::numbers::pi * sine.frequency_hz;
                    const double value = sine.amplitude_deg * portable::sin_degrees(angle_deg);
                    state.position_deg += value;
                    state.velocity_deg_s += sine.amplitude_deg * rad_s * portable::cos_degrees(angle_deg);
                    state.acceleration_deg_s2 -= rad_s * rad_s * value;
                }
                return state;
            }};
}

}  // namespace

const MotionKind motions::multisine{
    .name = "multisine",
    .summary = "swing at several frequencies at once",
    .equation =
        "q(t) = from + sum over k = 1 ... count of a_k * (sin(360deg * k * frequency * t + p_k) - sin(p_k)), "
        "a_k = amplitude / k / (1 + 1/2 + ... + 1/count), p_k = phase - 180deg * k * (k - 1) / count",
    .source = "Schroeder, IEEE Transactions on Information Theory 16, 1970, for the phases",
    .keys = keys,
    .make = make,
};

}  // namespace ripplenotch
