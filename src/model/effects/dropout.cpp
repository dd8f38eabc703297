// SPDX-License-Identifier: MIT
#include "model/effects.hpp"
#include "ripplenotch/model/noise.hpp"

namespace ripplenotch {
namespace {

constexpr Parameter parameters[] = {
    {.name = "rate_hz",
     .unit = "Hz",
     .help = "held stretches a second, on average",
     .start = 2.0,
     .upper = 1e4},
    {.name = "duration_s",
     .unit = "s",
     .help = "mean length; lengths are even between half and one and a half of it",
     .neutral = 0.1,
     .start = 0.1,
     .lower = 0.0,
     .upper = 1000.0},
    seed_parameter,
};

constexpr LookAlike look_alikes[] = {
    {"quantization", "the torque hardly changes, so that neighbouring samples are equal by nature",
     "counting the distinct values of the log"},
    {"saturation", "every held stretch lies at the extreme of the log", "a smaller torque"},
};

void apply(const Situation& situation, std::span<const double> values, std::span<double> torque_nm) {
    const double rate_hz = situation.motion.sample_rate.value();
    const double chance = values[0] / rate_hz;
    Noise noise(static_cast<std::uint64_t>(values[2]), NoiseChannel::dropout);
    double left = 0.0;
    for (std::size_t k = 1; k < torque_nm.size(); ++k) {
        const bool begins = noise.uniform() < chance;
        const double samples = (0.5 + noise.uniform()) * values[1] * rate_hz;
        if (left < 0.5 && begins) left = samples;
        if (left < 0.5) continue;
        torque_nm[k] = torque_nm[k - 1];
        left -= 1.0;
    }
}

}  // namespace

const Effect effects::dropout{
    .name = "dropout",
    .summary = "the log repeats old values where new ones were lost",
    .equation =
        "logged torque = last value before the stretch, in stretches of duration_s that begin rate_hz times "
        "a second",
    .symptom = "runs of equal values while the joint moves",
    .look_alikes = look_alikes,
    .source = "lost messages; found in public robot logs, where up to 37 % of the samples are held",
    .side = Side::converter,
    .domain = Domain::time,
    .parameters = parameters,
    .chance = true,
    .apply = apply,
};

}  // namespace ripplenotch
