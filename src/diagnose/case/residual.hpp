// SPDX-License-Identifier: MIT
#pragma once
// Measured less predicted torque of a case.

#include <vector>

#include "diagnose/case/case.hpp"

namespace ripplenotch {

/// Of the values that `use` counts.
[[nodiscard]] double rms_of(const std::vector<double>& values, const std::vector<unsigned char>& use);

/// Measured less predicted torque, a number a sample.
[[nodiscard]] std::vector<double> residual_nm(const Case& looked_at, const Model& stated);
/// rms of it over the samples that count.
[[nodiscard]] double left_rms(const Case& looked_at, const Model& stated);

}  // namespace ripplenotch
