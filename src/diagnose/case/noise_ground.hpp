// SPDX-License-Identifier: MIT
#pragma once
// What a model of far too many terms has of a case, whatever the model in hand: ripple of orders about the
// stated ones that swells with whatever the motion shows, and smooth shapes over position, speed and time.

#include <optional>
#include <span>
#include <vector>

#include "diagnose/case/case.hpp"
#include "diagnose/case/lines.hpp"
#include "diagnose/case/noise_columns.hpp"

namespace ripplenotch {

/// Cosine and sine at every sample, of `cycles` for one of `where`.
struct NoiseWave {
    NoiseWave(std::span<const double> where, double cycles);
    std::vector<double> cosine, sine;
};

void add_wave(NoiseColumns& columns, const NoiseWave& wave);

/// The columns of one case, and their products, between one look at its noise and the next: most of what a
/// look costs.
class NoiseGround {
  public:
    /// The columns, and nothing behind them. The case must outlive them, and stay as it is.
    [[nodiscard]] NoiseColumns& columns(const Case& looked_at, const StatedRipple& ripple,
                                        const DiagnosisRules::NoiseRules& rules);

  private:
    StatedRipple ripple_;
    std::optional<NoiseColumns> columns_;
    std::size_t count_ = 0;
};

}  // namespace ripplenotch
