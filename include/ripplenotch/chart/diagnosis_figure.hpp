// SPDX-License-Identifier: MIT
#pragma once
// Where a model and a log disagree, before and after.

#include <optional>
#include <span>
#include <string>

#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/figure/figure.hpp"

namespace ripplenotch {

/// The residual of the torque for two models, one value a sample; `position_deg` may be empty. `after_nm` may
/// be empty: one model only.
struct Residuals {
    std::span<const double> time_s, speed_deg_s, position_deg, before_nm, after_nm;
};

/// Residual against time, and its rms over position (time, without a position) and speed, with the same
/// colours before and after.
[[nodiscard]] Figure residual_figure(const std::string& title, const std::string& sentence,
                                     const Residuals& residuals, std::optional<double> noise_floor_nm);

/// The gap from round to round down to the noise floor, each round named.
[[nodiscard]] Figure gap_figure(const std::string& title, const Diagnosis& diagnosis);

/// The gap from round to round, and the residual of the model as given and of the improved one: against time,
/// and over position and speed.
[[nodiscard]] Figure diagnosis_figure(const std::string& source, const Diagnosis& diagnosis,
                                      const TraceView& log);

}  // namespace ripplenotch
