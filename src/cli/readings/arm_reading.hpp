// SPDX-License-Identifier: MIT
#pragma once
// All joints of an arm from one log, in the order of its chain.

#include <string>
#include <vector>

#include "ripplenotch/arm/arm_fit.hpp"
#include "ripplenotch/arm/joint_matching.hpp"
#include "ripplenotch/log/log.hpp"

namespace ripplenotch {

struct ArmReading {
    std::vector<Log> logs;  ///< a joint of the chain each
    JointMatch match;
    std::vector<std::string> names;  ///< of the joints in the log, in the order of the chain

    [[nodiscard]] ArmLog view() const;
    /// The place in the chain of a joint by its name in the log or in the chain, whatever its case. Throws
    /// UsageError with the nearest name.
    [[nodiscard]] std::size_t find(const Chain& chain, const std::string& joint) const;
};

/// Of a log with more than `most_rows` the pieces of read_log_in_part. Throws what
/// read_joints_at_once_in_part and match_joints throw, and UsageError where a joint of the chain has no
/// position.
[[nodiscard]] ArmReading read_arm(const std::string& path, const ReadOptions& options, std::size_t most_rows,
                                  const Chain& chain, const StatedJoints& stated);

}  // namespace ripplenotch
