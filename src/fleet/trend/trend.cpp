// SPDX-License-Identifier: MIT
#include "ripplenotch/fleet/trend.hpp"

#include <algorithm>
#include <cmath>

#include "core/matrices/least_squares.hpp"
#include "fleet/trend/joint_history.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t max_changes = 4;  // chosen, not derived
constexpr double spent_at_once = 0.8;   // chosen, not derived: share of the remaining false alarms
constexpr double min_t_squared = 9.0;   // limit for a descriptor that is listed with a change

// The same for a joint whatever else is in the fleet (Fowler, Noll and Vo).
std::uint64_t seed_of(const JointHistory& history, std::uint64_t seed, std::size_t turn) {
    std::uint64_t hash = 14695981039346656037U ^ seed;
    const std::string text = history.robot + "\n" + history.joint + "\n" + std::to_string(turn);
    for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211U;
    return hash;
}

JointChange told(const JointHistory& history, const std::vector<FoundChange>& known,
                 const FoundChange& found) {
    JointChange change;
    change.drift = found.drift;
    const std::size_t first = found.drift ? history.lines.size() - 1 : found.row;
    const std::size_t last = found.drift || found.row == 0 ? 0 : found.row - 1;
    change.date = *history.lines[first]->date;
    change.p = found.p;
    change.limit = found.limit;
    change.first_log = history.lines[first]->log;
    change.last_log = history.lines[last]->log;
    std::vector<std::pair<double, ChangedDescriptor>> parts;
    for (const Series& series : history.series) {
        const Regression regression = regression_of(history, series, known);
        const auto extra = regression.extra(change_column(history, found, series.rows));
        if (!extra) continue;
        const double half = normal_95_errors * extra->error, baseline = std::abs(regression.first_value());
        ChangedDescriptor part{series.name, extra->size, {extra->size - half, extra->size + half}, {}};
        if (baseline > 0.0 && !series.name.ends_with("_phase_deg"))
            part.percent = 100.0 * extra->size / baseline;
        parts.emplace_back(extra->t_squared, std::move(part));
    }
    std::stable_sort(parts.begin(), parts.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    for (auto& [t_squared, part] : parts)
        if (change.descriptors.empty() || t_squared >= min_t_squared)
            change.descriptors.push_back(std::move(part));
    return change;
}

std::vector<DescriptorTrend> told_descriptors(const JointHistory& history,
                                              const std::vector<FoundChange>& changes) {
    std::vector<DescriptorTrend> told;
    FoundChange drift;
    drift.drift = true;
    const double span_months = history.months();
    for (const Series& series : history.series) {
        const Regression regression = regression_of(history, series, changes);
        DescriptorTrend& one = told.emplace_back();
        one.name = series.name;
        one.lines = series.rows.size();
        one.baseline = regression.first_value();
        one.spread = regression.deviation();
        if (const auto slope = regression.extra(change_column(history, drift, series.rows));
            slope && span_months > 0.0) {
            one.slope_per_month = slope->size / span_months;
            one.slope_ci95 = Interval{(slope->size - normal_95_errors * slope->error) / span_months,
                                      (slope->size + normal_95_errors * slope->error) / span_months};
        }
    }
    told.insert(told.end(), history.untold.begin(), history.untold.end());
    return told;
}

// The surest descriptor of a change over all logs, less what its conditions explain; the changes stay.
std::vector<AdjustedValue> course_of(const JointHistory& history, const std::vector<FoundChange>& changes,
                                     const std::string& name) {
    const auto series = std::find_if(history.series.begin(), history.series.end(),
                                     [&](const Series& one) { return one.name == name; });
    if (series == history.series.end()) return {};
    const Regression regression = regression_of(history, *series, changes);
    std::vector<double> value = regression.residual();
    for (double& one : value) one += regression.first_value();
    for (std::size_t c = 0; c < changes.size(); ++c) {
        std::vector<FoundChange> others = changes;
        others.erase(others.begin() + static_cast<std::ptrdiff_t>(c));
        const auto column = change_column(history, changes[c], series->rows);
        const auto extra = regression_of(history, *series, others).extra(column);
        for (std::size_t i = 0; i < column.size() && extra; ++i) value[i] += extra->size * column[i];
    }
    std::vector<AdjustedValue> course;
    for (std::size_t i = 0; i < value.size(); ++i) {
        const FeatureLine& line = *history.lines[series->rows[i]];
        course.push_back({*line.date, value[i], line.log});
    }
    return course;
}

// The surest sign that a joint changed; 0 where it did not.
double surest_change(const JointTrend& joint) {
    double surest = 0.0;
    for (const JointChange& change : joint.changes)
        for (const ChangedDescriptor& one : change.descriptors)
            surest = std::max(surest, std::abs(one.size) / std::max(one.ci95.high - one.ci95.low, 1e-300));
    return surest;
}

// Each test spends most of the false-alarm probability that remains after those before it, so that all of
// them together have that of the rate.
std::vector<FoundChange> find_changes(const JointHistory& history, std::uint64_t seed,
                                      std::vector<JointChange>& changes) {
    std::vector<FoundChange> found;
    double left = std::min(0.5, false_alarms_per_joint_month * history.months());
    if (!(left > 0.0)) return found;
    while (found.size() < max_changes) {
        const double limit = spent_at_once * left;
        left -= limit;
        const auto next = next_change(history, found, limit, seed_of(history, seed, found.size()));
        if (!next) break;
        changes.push_back(told(history, found, *next));
        found.push_back(*next);
    }
    std::stable_sort(changes.begin(), changes.end(),
                     [](const JointChange& a, const JointChange& b) { return a.date < b.date; });
    return found;
}

JointTrend trend_of_joint(const JointHistory& history, std::uint64_t seed) {
    JointTrend joint;
    joint.robot = history.robot;
    joint.joint = history.joint;
    joint.lines = history.lines.size();
    joint.notes = history.notes;
    if (history.lines.empty()) return joint;
    joint.from = *history.lines.front()->date;
    joint.to = *history.lines.back()->date;
    joint.months = history.months();
    for (const Condition& condition : history.conditions) joint.conditions.push_back(condition.name);
    if (history.series.empty()) {
        joint.descriptors = history.untold;
        return joint;
    }
    if (!(history.day.back() > history.day.front())) {
        joint.notes.push_back("all its logs are of one moment");
        return joint;
    }
    const std::vector<FoundChange> found = find_changes(history, seed, joint.changes);
    joint.descriptors = told_descriptors(history, found);
    for (JointChange& change : joint.changes)
        if (!change.descriptors.empty())
            change.course = course_of(history, found, change.descriptors.front().name);
    return joint;
}

}  // namespace

Trend trend_of(std::span<const FeatureLine> lines, std::uint64_t seed) {
    Trend trend;
    trend.seed = seed;
    trend.lines = lines.size();
    trend.failed = static_cast<std::size_t>(
        std::count_if(lines.begin(), lines.end(), [](const FeatureLine& line) { return line.failed(); }));
    for (const JointHistory& history : joint_histories(lines, trend.notes)) {
        trend.joints.push_back(trend_of_joint(history, seed));
        const JointTrend& joint = trend.joints.back();
        if (!joint.looked_at()) continue;
        trend.joint_months += joint.months;
        trend.expected_false_alarms += std::min(0.5, false_alarms_per_joint_month * joint.months);
    }
    std::stable_sort(trend.joints.begin(), trend.joints.end(), [](const JointTrend& a, const JointTrend& b) {
        return surest_change(a) > surest_change(b);
    });
    return trend;
}

}  // namespace ripplenotch
