// SPDX-License-Identifier: MIT
#pragma once
// Which joint of a log is which of an arm, by their names alone, and how far each goes.

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ripplenotch/arm/chain.hpp"

namespace ripplenotch {

struct ArmFit;
struct ArmLog;

/// "panda_joint1" of the chain is "1" of the log.
using StatedJoints = std::vector<std::pair<std::string, std::string>>;

struct JointMatch {
    std::vector<std::size_t> of;  ///< for each joint of the chain, the place of its joint in the log
    std::string rule;             ///< "as stated", "by name", "by number", "by order"
    std::string option;           ///< option to force it: "joints=panda_joint1:1|panda_joint2:2"
    std::vector<std::string> warnings, notes;  ///< a sentence each
};

/// Joints that are stated first; then, for all the others, the first of these that finds one for each and no
/// two the same: the same name without case, '_', '-' and the words joint, axis, link, robot; the number at
/// the end of both names, the log's counted from 0 or 1; the order, where there are as many. Throws
/// UsageError that names the joint without a partner and the joints of the log.
[[nodiscard]] JointMatch match_joints(const Chain& chain, std::span<const std::string> log_joints,
                                      const StatedJoints& stated, std::string_view log_name);

// How far each joint of an arm goes in a log, and whether it can go there.

/// Below this travel, a link's inertia cannot be distinguished from the next one's.
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

/// Why the log determines fewer values of the arm than another one could; or nothing.
[[nodiscard]] std::vector<std::string> arm_warnings(const ArmFit& fit,
                                                    const std::vector<JointTravel>& travel);

}  // namespace ripplenotch
