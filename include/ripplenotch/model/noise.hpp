// SPDX-License-Identifier: MIT
#pragma once
// Chance that is the same on every machine.

#include <cstdint>
#include <random>
#include <span>

namespace ripplenotch {

/// The signal to which a noise stream belongs. Each has a stream of its own, so that adding noise to one
/// signal leaves the noise of another unchanged. The numbers are part of the definition of a seed: never
/// change one.
enum class NoiseChannel : std::uint64_t { torque = 1, velocity = 2, spikes = 3, dropout = 4 };

/// Normally distributed numbers that are the same on every machine: mt19937_64 (specified by the standard)
/// and our own transform, because std::normal_distribution differs between libraries.
class Noise {
  public:
    Noise(std::uint64_t seed, NoiseChannel channel);
    /// Mean 0, standard deviation 1 (Marsaglia's polar method).
    double normal();
    /// Uniform in [0, 1) with 53 random bits.
    double uniform();

  private:
    std::mt19937_64 engine_;
    double spare_ = 0.0;
    bool has_spare_ = false;
};

/// With `correlation` c in [0, 1) each number is c times the one before plus a fresh part (first-order
/// autoregression): 0 is white, near 1 is slow.
struct NoiseKind {
    double rms = 0.0, correlation = 0.0;
};
/// Adds noise to each value.
void add_noise(std::span<double> values, const NoiseKind& kind, std::uint64_t seed, NoiseChannel channel);

/// The same without correlation.
void add_white_noise(std::span<double> values, double rms, std::uint64_t seed, NoiseChannel channel);

}  // namespace ripplenotch
