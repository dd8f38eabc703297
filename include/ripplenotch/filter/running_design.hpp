// SPDX-License-Identifier: MIT
#pragma once
// The numbers that a method runs on, for exports.

#include <optional>

#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/design/running_design.hpp"
#include "ripplenotch/filter/method.hpp"

namespace ripplenotch {

/// Empty for methods that are coefficients, tables or maps. Throws UsageError on what cannot be designed at
/// this sample rate, and on settings that no code is written for, naming them.
[[nodiscard]] std::optional<RunningDesign> running_design(const Method& method, const Settings& settings,
                                                          Hertz sample_rate);

}  // namespace ripplenotch
