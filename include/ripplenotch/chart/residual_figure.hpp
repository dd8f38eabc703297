// SPDX-License-Identifier: MIT
#pragma once
// Where a model and a log disagree, before and after.

#include <optional>
#include <span>
#include <string>

#include "ripplenotch/figure/figure.hpp"

namespace ripplenotch {

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
