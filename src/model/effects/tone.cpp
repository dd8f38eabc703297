// SPDX-License-Identifier: MIT
#include "model/effects.hpp"
#include "model/evaluate.hpp"

namespace ripplenotch {
namespace {

constexpr Parameter parameters[] = {
    {.name = "frequency_hz",
     .unit = "Hz",
     .help = "cycles per second; 50 and 60 Hz and their multiples are mains",
     .neutral = 50.0,
     .start = 50.0,
     .lower = 0.001,
     .upper = 1e5,
     .hint = Hint::tones},
    {.name = "amplitude_nm",
     .unit = "Nm",
     .help = "zero to peak",
     .start = 0.1,
     .upper = 1e5,
     .linear = true},
    {.name = "phase_deg",
     .unit = "deg",
     .help = "phase of the cosine where the log begins",
     .lower = -360.0,
     .upper = 360.0},
};

constexpr LookAlike look_alikes[] = {
    {"ripple", "the log has one speed only", "a second speed, or a rest: a tone stays"},
    {"start-stop-ringing", "the log has few starts and it decays slowly", "a rest as long as several decays"},
};

void apply(const Situation& situation, std::span<const double> values, std::span<double> torque_nm) {
    const auto& time_s = situation.motion.time_s;
    with_cosines(
        torque_nm.size(),
        [&](std::size_t k) { return 360.0 * values[0] * (time_s[k] - time_s.front()) + values[2]; },
        [&](std::size_t k, double cosine) { torque_nm[k] += values[1] * cosine; });
}

}  // namespace

const Effect effects::tone{
    .name = "tone",
    .summary = "an oscillation of fixed frequency: mains, a fan, a servo's clock",
    .equation =
        "torque = amplitude_nm * cos(360 deg * frequency_hz * t + phase_deg), t = time since the log began",
    .symptom = "a line at one frequency whatever the speed, at rest too",
    .look_alikes = look_alikes,
    .source = "electrical interference; Kim, Kim, Song, Trans. KSME A, 2011, for the noise at rest",
    .side = Side::joint,
    .domain = Domain::frequency,
    .parameters = parameters,
    .polar = Polar{1, 2},
    .apply = apply,
};

}  // namespace ripplenotch
