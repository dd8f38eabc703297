// SPDX-License-Identifier: MIT
#pragma once
// The test bench: a running filter at one constant joint speed, fed with torque signals of the tool's own
// making. What it reports is what the filter put out, sample by sample; no formula stands in for it.

#include <array>
#include <memory>
#include <optional>

#include "ripplenotch/core/units.hpp"
#include "ripplenotch/evaluate/contender.hpp"

namespace ripplenotch {

/// Per cent of a step within which it counts as settled.
inline constexpr std::array<double, 4> settle_bands_percent = {0.5, 1.0, 2.0, 5.0};

struct StepMeasurement {
    std::array<Seconds, 4>
        settle;  ///< per entry of settle_bands_percent: from the step until it stays within
    double overshoot_percent = 0.0;  ///< above the step, in its direction
};

/// Attenuations above this cannot be told from a complete null in double precision and are reported as this.
inline constexpr double most_attenuation_db = 200.0;

class Bench {
  public:
    /// Borrows `contender`; `speed` may be 0. Throws UsageError when a measurement has not come to rest after
    /// 1e7 samples.
    Bench(const Contender& contender, Hertz sample_rate, DegPerSec speed)
        : contender_(contender), sample_rate_(sample_rate), speed_(speed) {}
    Bench(const Contender&& gone, Hertz sample_rate, DegPerSec speed) = delete;  // it is borrowed

    /// The torque is 0 for ever, and `height` Nm (not 0) from t = 0 on.
    [[nodiscard]] StepMeasurement step(NewtonMeters height) const;
    /// The torque is 0 for ever, and rises by `slope_nm_s` (not 0) from t = 0 on: how far the output lags
    /// behind once the lag no longer changes, to 1e-5 ms.
    [[nodiscard]] Seconds ramp_delay(double slope_nm_s) const;
    /// Input amplitude over output amplitude of a sine at `at`, once the output has settled; between -inf and
    /// most_attenuation_db. Empty unless 0 < at < sample_rate / 2.
    [[nodiscard]] std::optional<double> attenuation_db(Hertz at) const;

  private:
    const Contender& contender_;
    Hertz sample_rate_;
    DegPerSec speed_;
};

}  // namespace ripplenotch
