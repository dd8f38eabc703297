// SPDX-License-Identifier: MIT
#pragma once
// Changes in a fleet: for each joint and descriptor a baseline, a slope and change points, adjusted for
// temperature, load and motion, under one rate of false alarms for all of it.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ripplenotch/fleet/features.hpp"

namespace ripplenotch {

struct TrendOptions {
    double false_alarms = 0.001;  ///< expected number in a month of a joint without any change
    std::uint64_t seed = 1;       ///< seed of the permutations
};

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
    std::string page;  ///< address of the log's own report; empty: none known
};

/// How far a joint is from its baseline in a month, in the descriptor that is farthest.
struct JointMonth {
    std::string month;  ///< "2026-03"
    std::string descriptor;
    double deviations = 0.0;  ///< mean of the month less the baseline, in the spread of one log
};

/// One alert: something happened to the joint, or goes on.
struct JointChange {
    bool drift = false;            ///< no day: it went on from the first log to the last
    std::string cause;             ///< "Coulomb friction", "gain of the torque sensor"
    std::string date;              ///< date of the first log after it; for a drift, of the last
    std::string earliest, latest;  ///< days that are hardly distinguished from it by the logs
    double p = 1.0;                ///< chance that a joint in which nothing happens shows as much anywhere
    double limit = 0.0;            ///< the limit for p
    std::vector<ChangedDescriptor> descriptors;  ///< the descriptors that took part, the surest first
    std::size_t kin = 0;                ///< other joints of its kind with the same alert within 30 days
    std::string first_log, last_log;    ///< after it, and the last one before
    std::string first_date, last_date;  ///< dates of these two logs
    std::string first_page, last_page;  ///< addresses of their reports; empty: none known
    std::vector<AdjustedValue> course;  ///< time series of the surest descriptor, over all logs
};

/// A descriptor in which a joint is unlike the others of its kind.
struct OddDescriptor {
    std::string name;
    double baseline = 0.0, of_kind = 0.0;
    double deviations = 0.0;  ///< from the median of the kind, in its robust deviations
};

struct JointTrend {
    std::string robot, joint;
    std::size_t lines = 0;
    std::string from, to;  ///< dates
    double months = 0.0;
    std::vector<std::string> conditions;  ///< conditions that were regressed out
    std::vector<DescriptorTrend> descriptors;
    std::vector<JointChange> changes;  ///< in the order of their dates
    std::vector<OddDescriptor> odd;    ///< farthest first
    std::vector<JointMonth> course;    ///< months in which there are logs, in their order
    std::vector<std::string> notes;    ///< tests that could not be made, and why
    [[nodiscard]] std::string name() const { return robot.empty() ? joint : robot + " " + joint; }
};

struct Trend {
    std::vector<JointTrend> joints;  ///< those that changed otherwise than their kind first
    std::size_t lines = 0, failed = 0;
    double joint_months = 0.0;
    double expected_false_alarms = 0.0;  ///< at most, if nothing happened to any joint
    TrendOptions options;
    std::vector<std::string> notes;
};

/// Alerts whose course over all logs is shown: those of the joints that stand first.
inline constexpr std::size_t most_trend_courses = 10;

/// Fewest lines of a joint for a test.
inline constexpr std::size_t fewest_trend_lines = 10;

/// The order of the lines does not matter. Throws UsageError for a rate that is none; DataError: no lines,
/// lines of two versions of the tool, no dates, one log only, all of one date.
[[nodiscard]] Trend trend_of(std::span<const FeatureLine> lines, const TrendOptions& options);

}  // namespace ripplenotch
