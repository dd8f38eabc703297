// SPDX-License-Identifier: MIT
#pragma once
// What the values of a joint's motion say about their units, as they stand in the file.

#include <optional>
#include <vector>

namespace ripplenotch::layout_detail {

struct MotionEvidence {
    /// Change of position over velocity times time, in the file's units, magnitude; empty where there is no
    /// position, too little motion, or no agreement between the two.
    std::optional<double> scale;
    std::optional<double> wrap;  ///< the position starts again after so much
    double fastest = 0.0;        ///< largest magnitude of the velocity; without one, of the position's slope
    double farthest = 0.0;       ///< largest magnitude of the position
};

/// Vectors of equal length, in seconds and file units; velocity or position may be empty. Rows with a
/// not-a-number are left out.
[[nodiscard]] MotionEvidence motion_evidence(const std::vector<double>& time_s,
                                             const std::vector<double>& velocity,
                                             const std::vector<double>& position);

}  // namespace ripplenotch::layout_detail
