// SPDX-License-Identifier: MIT
#pragma once
#include <string>

#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/figure/figure.hpp"

namespace ripplenotch {

/// The gap from round to round, and the residual of the model as given and of the improved one: against time,
/// and over position and speed. Runs both models along the log's motion with the smoothing of the diagnosis.
[[nodiscard]] Figure diagnosis_figure(const std::string& source, const Diagnosis& diagnosis,
                                      const TraceView& log, Seconds smoothing);

}  // namespace ripplenotch
