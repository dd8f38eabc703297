// SPDX-License-Identifier: MIT
#include "ripplenotch/fleet/trend.hpp"

#include <algorithm>
#include <cmath>

#include "core/matrices/least_squares.hpp"
#include "fleet/trend/cause.hpp"
#include "fleet/trend/kinds.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t most_changes = 4;  // chosen, not derived
constexpr double spent_at_once = 0.8;    // chosen, not derived: share of the remaining false alarms
constexpr double least_t_squared = 9.0;  // limit for a descriptor that is listed with a change

// The same for a joint whatever else is in the fleet (Fowler, Noll and Vo).
std::uint64_t seed_of(const JointHistory& history, std::uint64_t seed, std::size_t turn) {
    std::uint64_t hash = 14695981039346656037U ^ seed;
    const std::string text = history.robot + "\n" + history.joint + "\n" + std::to_string(turn);
    for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211U;
    return hash;
}

JointChange told(const JointHistory& history, const std::vector<Regression>& known,
                 const ScatterOfSeries& scatter, const FoundChange& found) {
    const std::vector<ChangedSeries> changed = changed_series(history, known, scatter, found);
    JointChange change;
    change.drift = found.drift;
    change.cause = cause_of(history, known, found, changed);
    const auto date = [&](std::size_t row) { return *history.lines[row]->date; };
    change.date = date(found.drift ? history.lines.size() - 1 : found.row);
    change.earliest = date(found.drift ? 0 : found.earliest);
    change.latest = date(found.drift ? history.lines.size() - 1 : found.latest);
    change.p = found.p;
    change.limit = found.limit;
    const std::size_t first = found.drift ? history.lines.size() - 1 : found.row;
    const std::size_t last = found.drift || found.row == 0 ? 0 : found.row - 1;
    change.first_log = history.lines[first]->log;
    change.first_date = date(first);
    change.last_log = history.lines[last]->log;
    change.last_date = date(last);
    std::vector<ChangedSeries> sure = changed;
    std::stable_sort(sure.begin(), sure.end(), [](const ChangedSeries& a, const ChangedSeries& b) {
        return a.extra.t_squared > b.extra.t_squared;
    });
    for (const ChangedSeries& one : sure) {
        if (one.extra.t_squared < least_t_squared) continue;
        const Series& series = history.series[one.series];
        ChangedDescriptor part{series.name,
                               one.extra.size,
                               {one.extra.size - normal_95_errors * one.extra.error,
                                one.extra.size + normal_95_errors * one.extra.error},
                               {}};
        if (std::abs(one.baseline) > 0.0 && !series.name.ends_with("_phase_deg"))
            part.percent = 100.0 * one.extra.size / std::abs(one.baseline);
        change.descriptors.push_back(std::move(part));
    }
    return change;
}

std::vector<DescriptorTrend> told_descriptors(const JointHistory& history,
                                              const std::vector<FoundChange>& changes) {
    const std::vector<Regression> all = regressions(history, changes);
    std::vector<DescriptorTrend> told;
    FoundChange drift;
    drift.drift = true;
    const double span_months =
        history.day.empty() ? 0.0 : (history.day.back() - history.day.front()) / days_a_month;
    for (std::size_t s = 0; s < all.size(); ++s) {
        const Series& series = history.series[s];
        DescriptorTrend one;
        one.name = series.name;
        one.lines = series.rows.size();
        one.baseline = all[s].first_value();
        double squares = 0.0;
        for (std::size_t i = 0; i < series.rows.size(); ++i) {
            const double left = all[s].residual()[i] / all[s].weights()[i];
            squares += left * left;
        }
        one.spread = std::sqrt(squares / std::max(all[s].freedom(), 1.0));
        if (const auto slope = all[s].extra(change_column(history, drift, series.rows));
            slope && span_months > 0.0) {
            one.slope_per_month = slope->size / span_months;
            one.slope_ci95 = Interval{(slope->size - normal_95_errors * slope->error) / span_months,
                                      (slope->size + normal_95_errors * slope->error) / span_months};
        }
        told.push_back(std::move(one));
    }
    told.insert(told.end(), history.untold.begin(), history.untold.end());
    return told;
}

// Each test spends most of the false-alarm probability that remains after those before it, so that all of
// them together have that of the rate.
std::vector<FoundChange> find_changes(const JointHistory& history, const ScatterOfSeries& scatter,
                                      const TrendOptions& options, std::vector<JointChange>& changes) {
    std::vector<FoundChange> found;
    double left = std::min(0.5, options.false_alarms * history.months());
    if (!(left > 0.0)) return found;
    while (found.size() < most_changes) {
        const double limit = spent_at_once * left;
        left -= limit;
        const std::vector<Regression> known = regressions(history, found);
        const auto next =
            next_change(history, known, scatter, limit, seed_of(history, options.seed, found.size()));
        if (!next) break;
        changes.push_back(told(history, known, scatter, *next));
        found.push_back(*next);
    }
    std::stable_sort(changes.begin(), changes.end(),
                     [](const JointChange& a, const JointChange& b) { return a.date < b.date; });
    return found;
}

JointTrend trend_of_joint(const JointHistory& history, const ScatterOfSeries& scatter,
                          const TrendOptions& options) {
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
    const std::vector<FoundChange> found = find_changes(history, scatter, options, joint.changes);
    joint.descriptors = told_descriptors(history, found);
    tell_courses(history, found, joint);
    return joint;
}

}  // namespace

Trend trend_of(std::span<const FeatureLine> lines, const TrendOptions& options) {
    if (!(options.false_alarms > 0.0 && options.false_alarms <= 0.5))
        raise<UsageError>("--false-alarms {} is not between 0 and 0.5", shortest(options.false_alarms));
    Trend trend;
    trend.options = options;
    trend.lines = lines.size();
    trend.failed = static_cast<std::size_t>(
        std::count_if(lines.begin(), lines.end(), [](const FeatureLine& line) { return line.failed(); }));
    const std::vector<JointHistory> histories = joint_histories(lines, trend.notes);
    const std::vector<ScatterOfSeries> scatter = scatter_of_kin(histories);
    for (std::size_t h = 0; h < histories.size(); ++h) {
        trend.joints.push_back(trend_of_joint(histories[h], scatter[h], options));
        const JointTrend& joint = trend.joints.back();
        const bool looked_at =
            std::any_of(joint.descriptors.begin(), joint.descriptors.end(),
                        [](const DescriptorTrend& one) { return one.baseline.has_value(); });
        if (!looked_at) continue;
        trend.joint_months += joint.months;
        trend.expected_false_alarms += std::min(0.5, options.false_alarms * joint.months);
    }
    compare_kinds(trend.joints);
    return trend;
}

}  // namespace ripplenotch
