// SPDX-License-Identifier: MIT
#pragma once
// Changes in a fleet: for each joint and descriptor a baseline, a slope and change points, adjusted for
// temperature, load and motion, under one rate of false alarms for all of it.

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ripplenotch/fleet/features.hpp"

namespace ripplenotch {

/// Expected number in a month of a joint without any change.
inline constexpr double false_alarms_per_joint_month = 0.001;

/// One descriptor over the logs of a joint.
struct DescriptorTrend {
    std::string name;                       ///< with its unit
    std::size_t lines = 0;                  ///< lines that contain it
    std::optional<double> baseline;         ///< before the first change, at the joint's median conditions
    std::optional<double> slope_per_month;  ///< fitted together with the changes that were found
    std::optional<Interval> slope_ci95;
    double spread = 0.0;  ///< rms of a log about all this
    std::string reason;   ///< reason for an absent baseline
};

/// By how much a descriptor is another one after a change; of a drift, from its first log to its last.
struct ChangedDescriptor {
    std::string name;
    double size = 0.0;
    Interval ci95;
    std::optional<double> percent;  ///< change relative to the baseline
};

/// A value of a descriptor as it would have been at the joint's median conditions.
struct AdjustedValue {
    std::string date;
    double value = 0.0;
    std::string log;
};

/// One alert: something happened to the joint, or goes on.
struct JointChange {
    bool drift = false;  ///< no day: it went on from the first log to the last
    std::string date;    ///< date of the first log after it; for a drift, of the last
    double p = 1.0;      ///< chance that a joint in which nothing happens shows as much anywhere
    double limit = 0.0;  ///< the limit for p
    std::vector<ChangedDescriptor> descriptors;  ///< the descriptors that took part, the surest first
    std::string first_log, last_log;             ///< after it, and the last one before
    std::vector<AdjustedValue> course;           ///< time series of the surest descriptor, over all logs
};

struct JointTrend {
    std::string robot, joint;
    std::size_t lines = 0;
    std::string from, to;  ///< dates
    double months = 0.0;
    std::vector<std::string> conditions;  ///< conditions that were regressed out
    std::vector<DescriptorTrend> descriptors;
    std::vector<JointChange> changes;  ///< in the order of their dates
    std::vector<std::string> notes;    ///< tests that could not be made, and why
    [[nodiscard]] std::string name() const { return robot.empty() ? joint : robot + " " + joint; }
    /// It had enough logs of different days to be tested.
    [[nodiscard]] bool looked_at() const {
        return std::any_of(descriptors.begin(), descriptors.end(),
                           [](const DescriptorTrend& one) { return one.baseline.has_value(); });
    }
};

struct Trend {
    std::vector<JointTrend> joints;  ///< those that changed most first
    std::size_t lines = 0, failed = 0;
    double joint_months = 0.0;
    double expected_false_alarms = 0.0;  ///< at most, if nothing happened to any joint
    std::uint64_t seed = 1;              ///< of the permutations
    std::vector<std::string> notes;
};

/// Alerts whose course over all logs is shown: those of the joints that stand first.
inline constexpr std::size_t max_trend_courses = 10;

/// Fewest lines of a joint for a test.
inline constexpr std::size_t fewest_trend_lines = 10;

/// The order of the lines does not matter. Throws DataError: no lines, lines of two versions of the tool, no
/// dates, one log only, all of one date.
[[nodiscard]] Trend trend_of(std::span<const FeatureLine> lines, std::uint64_t seed);

}  // namespace ripplenotch
