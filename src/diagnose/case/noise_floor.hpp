// SPDX-License-Identifier: MIT
#pragma once
// Size and colour of the noise of a log, from what a model of far too many terms leaves: taken from the
// residual of the model in hand, the noise would grow with what the model misses.

#include <vector>

#include "diagnose/case/case.hpp"
#include "diagnose/case/noise_ground.hpp"

namespace ripplenotch {

struct NoiseFloor {
    double rms_nm = 0.0;                      ///< of the noise
    double white_nm = 0.0;                    ///< rms of its white part
    std::vector<double> color;                ///< coefficients of FitOptions::noise_color
    double material_nm = 0.0;                 ///< rms against which a torque matters or not; 0: rms_nm
    std::vector<double> covariance_nm2 = {};  ///< at lags 0, 1, ... samples

    /// The whitening filter of every step-th sample, of at most this many lags.
    struct Thinned {
        std::vector<double> color;
        double white_nm = 0.0;
        double density_nm2 = 0.0;  ///< power spectral density at 0 Hz, in Nm^2 times the full sample period
    };
    [[nodiscard]] Thinned thinned(std::size_t step, std::size_t most_lags, double samples,
                                  double lag_price) const;

    /// Variance of a sum over many samples, against that of white noise of the same rms; at least 1.
    [[nodiscard]] double of_sums() const;
};

/// `model`: the best one so far, wholly stated; its own slopes take part.
[[nodiscard]] NoiseFloor noise_floor(const Case& looked_at, const Model& model, const Model& open,
                                     const DiagnosisRules& rules);
/// The same, where the noise of this case is looked at again and again.
[[nodiscard]] NoiseFloor noise_floor(const Case& looked_at, const Model& model, const Model& open,
                                     const DiagnosisRules& rules, NoiseGround& ground);

/// Where more than noise is left of the best model: what is left, as noise with a memory of `memory_s`. Names
/// are weighed where it is quiet.
[[nodiscard]] NoiseFloor noise_of_residual(const Case& looked_at, const std::vector<double>& residual_nm,
                                           const NoiseFloor& floor, const DiagnosisRules& rules);

}  // namespace ripplenotch
