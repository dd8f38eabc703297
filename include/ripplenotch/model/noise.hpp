// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <random>

namespace ripplenotch {

/// Normally distributed numbers that are the same on every machine: mt19937_64 (specified by the standard) and our own
/// transform, because std::normal_distribution differs between libraries.
class Noise {
  public:
    explicit Noise(std::uint64_t seed) : engine_(seed) {}
    /// Mean 0, standard deviation 1 (Marsaglia polar method).
    double normal();
    /// Uniform in [0, 1) with 53 random bits.
    double uniform();

  private:
    std::mt19937_64 engine_;
    double spare_ = 0.0;
    bool has_spare_ = false;
};

}  // namespace ripplenotch
