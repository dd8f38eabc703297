// SPDX-License-Identifier: MIT
#pragma once
// A joint.json, and what it says about the gear.

#include <optional>
#include <string>
#include <vector>

#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/core/units.hpp"
#include "ripplenotch/document/provenance.hpp"

namespace ripplenotch {

struct JointFacts {
    std::string source;  ///< for messages
    Hertz sample_rate;   ///< nominal: what filter designs for on the same log
    std::optional<GearRatio> gear_ratio;
    double ratio_error =
        0.0;  ///< share: the further end of the file's 95 % interval; 0 for a ratio that is given
    std::vector<Order> orders;         ///< of the lines that follow the motor, lowest first, each once
    std::vector<double> amplitude_nm;  ///< one per order
    std::vector<double> phase_deg;     ///< one per order, or empty where one of them is not known
    DegPerSec slowest, fastest;        ///< |v| at which those lines were seen; both 0 without lines
};

struct JointFile {
    std::string path, source;  ///< the source is for messages
    Identification found;

    /// A line that was seen at one speed only counts when identify gave it an order: then the gear ratio
    /// rests on it. With a ratio from elsewhere the orders are those of the measured lines under that ratio,
    /// whole or half where they are within 0.5 % of it. Of two lines of one order the stronger one counts.
    [[nodiscard]] JointFacts facts(std::optional<GearRatio> given = std::nullopt) const;
};

/// Reads joint.json, or standard input when the path is "-". Throws DataError, FileError, and UsageError for
/// an empty path.
[[nodiscard]] JointFile load_joint(const std::string& path);

/// The file with its hash, for the artifact that is made from it. Standard input has no hash: it is gone.
[[nodiscard]] InputRecord input_record(const std::string& path);

}  // namespace ripplenotch
