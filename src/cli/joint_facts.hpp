// SPDX-License-Identifier: MIT
#pragma once
// What design and compare take from a joint.json.

#include <optional>
#include <string>
#include <vector>

#include "ripplenotch/artifact/document.hpp"
#include "ripplenotch/core/units.hpp"

namespace ripplenotch {

struct JointFacts {
    std::string source;  ///< for messages
    std::optional<GearRatio> gear_ratio;
    double ratio_error = 0.0;   ///< share: the further end of the file's 95 % interval; 0 with --gear-ratio
    std::vector<Order> orders;  ///< of the lines that follow the speed, lowest first, each once
    std::vector<double> amplitude_nm;  ///< one per order
    DegPerSec slowest, fastest;        ///< |v| at which those lines were seen; both 0 without lines
    Hertz sample_rate;                 ///< nominal: what filter designs for on the same log
};

/// Reads joint.json, or standard input when the path is "-". With `gear_ratio` (from --gear-ratio) the orders
/// are those of the measured lines under that ratio, whole or half where they are within 0.5 % of it. Throws
/// DataError, FileError, UsageError unless the ratio is above 0.
[[nodiscard]] JointFacts load_joint_facts(const std::string& path,
                                          std::optional<GearRatio> gear_ratio = std::nullopt);

/// The gear ratio, or a DataError that says why there is none and that --gear-ratio gives one.
[[nodiscard]] GearRatio gear_ratio_of(const JointFacts& joint);

/// The file with its hash, for the artifact that is made from it. Standard input has no hash: it is gone.
[[nodiscard]] InputRecord input_record(const std::string& path);

}  // namespace ripplenotch
