// SPDX-License-Identifier: MIT
#pragma once
// Internal: the lines of one joint in the order of their dates, as columns.

#include <span>
#include <string>
#include <vector>

#include "ripplenotch/fleet/trend.hpp"

namespace ripplenotch {

inline constexpr double days_a_month = 365.25 / 12.0;

/// One descriptor in the rows that contain it.
struct Series {
    std::string name;
    bool torque = false;  ///< scales with the gain of the torque sensor
    std::vector<std::size_t> rows;
    std::vector<double> value, error;  ///< error: standard, 0 where it is not known
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
    [[nodiscard]] std::string name() const { return robot.empty() ? joint : robot + " " + joint; }
};

/// The histories of all joints, by robot and joint. Throws what trend_of() throws for its lines; `notes`
/// receives the notes on the fleet.
[[nodiscard]] std::vector<JointHistory> joint_histories(std::span<const FeatureLine> lines,
                                                        std::vector<std::string>& notes);

}  // namespace ripplenotch
