// SPDX-License-Identifier: MIT
#include "model/effects.hpp"
#include "ripplenotch/model/noise.hpp"

namespace ripplenotch {
namespace {

constexpr Parameter parameters[] = {
    {.name = "rate_percent",
     .unit = "%",
     .help = "of the samples that are hit",
     .start = 0.1,
     .upper = 100.0},
    {.name = "size_nm",
     .unit = "Nm",
     .help = "of a spike; its sign is chance",
     .start = 5.0,
     .upper = 1e5,
     .linear = true},
    seed_parameter,
};

constexpr LookAlike look_alikes[] = {
    {"noise with heavy tails", "the spikes are no larger than seven times its rms",
     "a rest: spikes stand alone"},
};

void apply(const Situation&, std::span<const double> values, std::span<double> torque_nm) {
    Noise noise(static_cast<std::uint64_t>(values[2]), NoiseChannel::spikes);
    for (std::size_t k = 0; k < torque_nm.size(); ++k) {
        const bool hit = noise.uniform() < 0.01 * values[0], up = noise.uniform() < 0.5;
        if (hit) torque_nm[k] += up ? values[1] : -values[1];
    }
}

}  // namespace

const Effect effects::spikes{
    .name = "spikes",
    .summary = "single samples are far off",
    .equation = "logged torque = torque + size_nm or - size_nm, in rate_percent of the samples",
    .symptom = "single samples far outside the noise, at no particular time, speed or position",
    .look_alikes = look_alikes,
    .source = "lost bits and electrical pulses",
    .side = Side::converter,
    .domain = Domain::time,
    .parameters = parameters,
    .chance = true,
    .apply = apply,
};

}  // namespace ripplenotch
