// SPDX-License-Identifier: MIT
#pragma once
// A log of an arm's joints as the fit may use it.

#include <vector>

#include "ripplenotch/arm/arm_fit.hpp"

namespace ripplenotch {

struct CheckedLog {
    const ArmLog& log;
    std::vector<Motion> friction;     ///< whose speed friction sees
    std::vector<std::size_t> fitted;  ///< joints whose torque counts
    std::vector<bool> use;            ///< by row
};

/// Throws as fit_arm. Rows in which nothing moves for more than a second count only in that second: they say
/// one thing over and over.
[[nodiscard]] CheckedLog check_log(const Chain& chain, const ArmLog& log, const ArmFitOptions& options);

}  // namespace ripplenotch
