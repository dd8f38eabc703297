// SPDX-License-Identifier: MIT
#include "ripplenotch/model/noise.hpp"

#include <cmath>

#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

namespace {

// SplitMix64's finalizer (Steele, Lea, Flood 2014): neighbouring seeds and channels become unrelated engine
// seeds.
std::uint64_t mixed(std::uint64_t seed, NoiseChannel channel) {
    std::uint64_t z = seed + 0x9e3779b97f4a7c15U * static_cast<std::uint64_t>(channel);
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
    return z ^ (z >> 31U);
}

}  // namespace

Noise::Noise(std::uint64_t seed, NoiseChannel channel) : engine_(mixed(seed, channel)) {}

double Noise::uniform() { return static_cast<double>(engine_() >> 11U) * 0x1p-53; }

double Noise::normal() {
    if (has_spare_) {
        has_spare_ = false;
        return spare_;
    }
    // A point uniform in the unit disc; its squared radius is uniform too, and independent of its direction.
    double x = 0.0, y = 0.0, square = 0.0;
    do {
        x = 2.0 * uniform() - 1.0;
        y = 2.0 * uniform() - 1.0;
        square = x * x + y * y;
    } while (square >= 1.0 || square == 0.0);
    const double stretch = std::sqrt(-2.0 * portable::log(square) / square);
    spare_ = y * stretch;
    has_spare_ = true;
    return x * stretch;
}

void add_noise(std::span<double> values, const NoiseKind& kind, std::uint64_t seed, NoiseChannel channel) {
    const auto [rms, correlation] = kind;
    if (rms == 0.0) return;
    Noise noise(seed, channel);
    // The first number is drawn from where the process settles, so that the rms is the same from the start.
    const double fresh = std::sqrt(1.0 - correlation * correlation);
    double state = 0.0, share = 1.0;
    for (double& value : values) {
        state = correlation * state + share * noise.normal();
        share = fresh;
        value += rms * state;
    }
}

void add_white_noise(std::span<double> values, double rms, std::uint64_t seed, NoiseChannel channel) {
    add_noise(values, {.rms = rms}, seed, channel);
}

}  // namespace ripplenotch
