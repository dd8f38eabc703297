// SPDX-License-Identifier: MIT
#pragma once
// How far each joint of an arm goes in a log, and whether it can go there.

#include <vector>

#include "ripplenotch/arm/arm_fit.hpp"

namespace ripplenotch {

/// Less than this, and a link's inertia cannot be told from the next one's.
inline constexpr double least_travel_deg = 5.0;

struct JointTravel {
    std::string name;       ///< in the chain
    std::string log;        ///< in the log
    double travel_deg = 0;  ///< from its least to its greatest position; of a prismatic joint m
};

/// `log_joints`: the joints' names in the log, in the order of the chain. Throws DataError where a position
/// is so far out of the chain's limits, so often, that its unit must be another one.
[[nodiscard]] std::vector<JointTravel> arm_travel(const Chain& chain, const ArmLog& log,
                                                  const std::vector<std::string>& log_joints);

/// Why the log tells less of the arm than another one could; or nothing.
[[nodiscard]] std::vector<std::string> arm_warnings(const ArmFit& fit,
                                                    const std::vector<JointTravel>& travel);

}  // namespace ripplenotch
