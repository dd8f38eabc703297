// SPDX-License-Identifier: MIT
#pragma once
// What the equations of an envelope do to a signal when one line is alone: bandwidth and noise as obtained.

#include <vector>

#include "analysis/track/envelope_solver.hpp"
#include "ripplenotch/core/units.hpp"

namespace ripplenotch {

/// Of a run of `duration_s`, from the equations as they are solved, with the data at their mean.
class EnvelopeKernel {
  public:
    EnvelopeKernel(const EnvelopeSettings& settings, double duration_s, Hertz asked_bandwidth);

    /// -3 dB width in the middle of the run, both sides together.
    [[nodiscard]] Hertz bandwidth() const { return bandwidth_; }
    /// Standard error of an amplitude per unit of rms noise on the samples, by the distance to an end of the
    /// run in points; the last entry holds beyond.
    [[nodiscard]] const std::vector<double>& error_factors() const { return error_factors_; }
    /// Degrees of freedom that one component takes from the data, per sample.
    [[nodiscard]] double freedom_per_sample() const { return freedom_per_sample_; }

  private:
    Hertz bandwidth_;
    std::vector<double> error_factors_;
    double freedom_per_sample_ = 0.0;
};

}  // namespace ripplenotch
