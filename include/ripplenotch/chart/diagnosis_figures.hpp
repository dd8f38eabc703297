// SPDX-License-Identifier: MIT
#pragma once
// Where a model and a log disagree, before and after, and how the gap between them shrank.

#include <optional>
#include <span>
#include <string>

#include "ripplenotch/figure/figure.hpp"

namespace ripplenotch {

/// One round: the effect that was added and the rms residual without and with it.
struct GapRound {
    std::string name;  ///< "coulomb-friction", "ripple (ambiguous)"
    double before_nm = 0.0, after_nm = 0.0;
};

/// The gap from round to round down to the noise floor, each round named.
[[nodiscard]] Figure gap_figure(const std::string& title, const std::string& sentence,
                                std::span<const GapRound> rounds, double noise_floor_nm);

/// What is left of the torque by two models, one value a sample; `position_deg` may be empty. `after_nm` may
/// be empty: one model only.
struct Residuals {
    std::span<const double> time_s, speed_deg_s, position_deg, before_nm, after_nm;
};

/// Residual against time, and its rms over position (time, without a position) and speed, with the same
/// colours before and after.
[[nodiscard]] Figure residual_figure(const std::string& title, const std::string& sentence,
                                     const Residuals& residuals, std::optional<double> noise_floor_nm);

}  // namespace ripplenotch
