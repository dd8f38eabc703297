// SPDX-License-Identifier: MIT
#pragma once
// What an improved model leaves above the noise, and where.

#include <optional>
#include <span>

#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/model/motion.hpp"

namespace ripplenotch {

/// Empty where the residual is noise. `noise_nm` is what no smooth law explains.
[[nodiscard]] std::optional<RemainingResidual> remaining_residual(const Motion& motion,
                                                                  std::span<const double> residual_nm,
                                                                  std::span<const unsigned char> use,
                                                                  double noise_nm);

}  // namespace ripplenotch
