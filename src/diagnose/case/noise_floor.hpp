// SPDX-License-Identifier: MIT
#pragma once
// Size and colour of the noise of a log, from what a model of far too many terms leaves: taken from the
// residual of the model in hand, the noise would grow with what the model misses.

#include <vector>

#include "diagnose/case/case.hpp"
#include "diagnose/case/noise_ground.hpp"

namespace ripplenotch {

struct NoiseFloor {
    double rms_nm = 0.0;        ///< of the noise
    double white_nm = 0.0;      ///< rms of its white part
    std::vector<double> color;  ///< coefficients of FitOptions::noise_color

    /// Variance of a sum over many samples, against that of white noise of the same rms; at least 1.
    [[nodiscard]] double of_sums() const;
};

/// `model`: the best one so far, wholly stated; its own slopes take part.
[[nodiscard]] NoiseFloor noise_floor(const Case& looked_at, const Model& model, const Model& open,
                                     const DiagnosisRules& rules);
/// The same, where the noise of this case is looked at again and again.
[[nodiscard]] NoiseFloor noise_floor(const Case& looked_at, const Model& model, const Model& open,
                                     const DiagnosisRules& rules, NoiseGround& ground);

}  // namespace ripplenotch
