// SPDX-License-Identifier: MIT
#pragma once
// Internal: the lines of one joint in the order of their dates, as columns.

#include <span>
#include <string>
#include <vector>

#include "ripplenotch/fleet/trend.hpp"

namespace ripplenotch {

/// One descriptor in the rows that contain it.
struct Series {
    std::string name;
    std::vector<std::size_t> rows;
    std::vector<double> value;
};

struct Condition {
    std::string name;
    std::vector<double> value;  ///< less its median, a number per row
};

struct JointHistory {
    std::string robot, joint;
    std::vector<const FeatureLine*> lines;
    std::vector<double> day;  ///< since 1970
    std::vector<Condition> conditions;
    std::vector<Series> series;
    std::vector<DescriptorTrend> untold;  ///< descriptors that too few lines contain
    std::vector<std::string> notes;

    [[nodiscard]] double months() const;
};

/// The histories of all joints, by robot and joint. Throws what trend_of() throws for its lines; `notes`
/// receives the notes on the fleet.
[[nodiscard]] std::vector<JointHistory> joint_histories(std::span<const FeatureLine> lines,
                                                        std::vector<std::string>& notes);

}  // namespace ripplenotch
