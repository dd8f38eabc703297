// SPDX-License-Identifier: MIT
#pragma once

namespace ripplenotch {

/// Half the width of a two-sided 95 % interval of a normal distribution, in standard errors: the quantile of
/// 0.975.
inline constexpr double normal_95_errors = 1.959963984540054;

}  // namespace ripplenotch
