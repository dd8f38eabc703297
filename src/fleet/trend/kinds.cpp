// SPDX-License-Identifier: MIT
#include "fleet/trend/kinds.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <tuple>

#include "ripplenotch/core/number.hpp"
#include "ripplenotch/fleet/features.hpp"

namespace ripplenotch {

namespace {

/// A series less its baseline and what its conditions explain; the changes stay.
struct Adjusted {
    std::vector<double> deviation;  ///< in the series' own unit, a number per row of it
    double baseline = 0.0, spread = 0.0;
};

std::vector<Adjusted> adjusted_of(const JointHistory& history, std::span<const FoundChange> changes) {
    const std::vector<Regression> all = regressions(history, changes);
    std::vector<Adjusted> adjusted(all.size());
    for (std::size_t s = 0; s < all.size(); ++s) {
        const auto& residual = all[s].residual();
        adjusted[s].baseline = all[s].first_value();
        double squares = 0.0;
        for (std::size_t i = 0; i < residual.size(); ++i) {
            adjusted[s].deviation.push_back(residual[i] / all[s].weights()[i]);
            squares += adjusted[s].deviation[i] * adjusted[s].deviation[i];
        }
        adjusted[s].spread = std::sqrt(squares / std::max(all[s].freedom(), 1.0));
    }
    for (std::size_t c = 0; c < changes.size(); ++c) {
        std::vector<FoundChange> others(changes.begin(), changes.end());
        others.erase(others.begin() + static_cast<std::ptrdiff_t>(c));
        const std::vector<Regression> without = regressions(history, others);
        for (std::size_t s = 0; s < all.size(); ++s) {
            const auto column = change_column(history, changes[c], history.series[s].rows);
            const auto extra = without[s].extra(column);
            if (!extra) continue;
            for (std::size_t i = 0; i < column.size(); ++i)
                adjusted[s].deviation[i] += extra->size * column[i];
        }
    }
    return adjusted;
}

std::vector<JointMonth> months_of(const JointHistory& history, const std::vector<Adjusted>& adjusted) {
    std::map<std::string, JointMonth> months;
    for (std::size_t s = 0; s < adjusted.size(); ++s) {
        std::map<std::string, std::pair<double, double>> sums;
        for (std::size_t i = 0; i < adjusted[s].deviation.size(); ++i) {
            auto& [sum, count] = sums[history.lines[history.series[s].rows[i]]->date->substr(0, 7)];
            sum += adjusted[s].deviation[i];
            count += 1.0;
        }
        for (const auto& [month, sum] : sums) {
            JointMonth& one = months.try_emplace(month, JointMonth{month, {}, 0.0}).first->second;
            const double deviations =
                adjusted[s].spread > 0.0 ? sum.first / sum.second / adjusted[s].spread : 0.0;
            if (!one.descriptor.empty() && std::abs(deviations) <= std::abs(one.deviations)) continue;
            one.descriptor = history.series[s].name;
            one.deviations = deviations;
        }
    }
    std::vector<JointMonth> list;
    for (auto& [name, month] : months) list.push_back(std::move(month));
    return list;
}

}  // namespace

void tell_courses(const JointHistory& history, std::span<const FoundChange> changes, JointTrend& joint) {
    const std::vector<Adjusted> adjusted = adjusted_of(history, changes);
    joint.course = months_of(history, adjusted);
    for (JointChange& change : joint.changes) {
        if (change.descriptors.empty()) continue;
        for (std::size_t s = 0; s < adjusted.size(); ++s) {
            const Series& series = history.series[s];
            if (series.name != change.descriptors.front().name) continue;
            for (std::size_t i = 0; i < series.rows.size(); ++i)
                change.course.push_back({*history.lines[series.rows[i]]->date,
                                         adjusted[s].baseline + adjusted[s].deviation[i],
                                         history.lines[series.rows[i]]->log,
                                         {}});
        }
    }
}

namespace {

constexpr std::size_t fewest_kin = 5;  // chosen, not derived
constexpr double odd_from = 5.0;       // robust deviations
// Share of the kind's median: a smaller difference is no other joint.
constexpr double least_deviation = 0.01;
constexpr double same_time_s = 30.0 * 86400.0;  // chosen, not derived: a month
constexpr double shared_part = 0.3;  // share of a kind, from which a change is none of the joint alone

using Kind = std::vector<JointTrend*>;

void find_odd(const Kind& kind) {
    std::map<std::string, std::vector<std::pair<JointTrend*, double>>> baselines;
    for (JointTrend* joint : kind)
        for (const DescriptorTrend& one : joint->descriptors)
            if (one.baseline && !one.name.ends_with("_phase_deg"))
                baselines[one.name].emplace_back(joint, *one.baseline);
    for (auto& [name, all] : baselines) {
        if (all.size() < fewest_kin) continue;
        std::vector<double> values, off;
        for (const auto& [joint, value] : all) values.push_back(value);
        const double middle = median_in(values);
        for (const auto& [joint, value] : all) off.push_back(std::abs(value - middle));
        const double deviation =
            std::max(deviations_of_median * median_in(off), least_deviation * std::abs(middle));
        for (const auto& [joint, value] : all) {
            const double deviations = deviation > 0.0 ? (value - middle) / deviation : 0.0;
            if (std::abs(deviations) >= odd_from) joint->odd.push_back({name, value, middle, deviations});
        }
    }
}

void find_shared(const Kind& kind) {
    for (JointTrend* joint : kind) {
        for (JointChange& change : joint->changes) {
            change.kin = 0;
            const double at_s = date_seconds(change.date).value_or(0.0);
            for (const JointTrend* other : kind) {
                if (other == joint) continue;
                change.kin +=
                    std::any_of(other->changes.begin(), other->changes.end(), [&](const JointChange& one) {
                        return one.cause == change.cause && one.drift == change.drift &&
                               std::abs(date_seconds(one.date).value_or(0.0) - at_s) <= same_time_s;
                    });
            }
        }
    }
}

// The surest sign that a joint changed; 0 where it did not, or as its kind did.
double own_change(const JointTrend& joint, std::size_t kin) {
    double surest = 0.0;
    for (const JointChange& change : joint.changes) {
        if (kin >= fewest_kin && static_cast<double>(change.kin) > shared_part * static_cast<double>(kin))
            continue;
        for (const ChangedDescriptor& one : change.descriptors)
            surest = std::max(surest, std::abs(one.size) / std::max(one.ci95.high - one.ci95.low, 1e-300));
    }
    return surest;
}

}  // namespace

void compare_kinds(std::vector<JointTrend>& joints) {
    std::map<std::string, Kind> kinds;
    for (JointTrend& joint : joints) kinds[joint.joint].push_back(&joint);
    for (auto& [name, kind] : kinds) {
        if (kind.size() >= fewest_kin) find_odd(kind);
        find_shared(kind);
    }
    for (JointTrend& joint : joints)
        std::sort(joint.odd.begin(), joint.odd.end(), [](const OddDescriptor& a, const OddDescriptor& b) {
            return std::make_tuple(-std::abs(a.deviations), a.name) <
                   std::make_tuple(-std::abs(b.deviations), b.name);
        });
    const auto key = [&](const JointTrend& joint) {
        const double own = own_change(joint, kinds[joint.joint].size());
        const double odd = joint.odd.empty() ? 0.0 : std::abs(joint.odd.front().deviations);
        return std::make_tuple(-own, -odd, joint.changes.empty(), joint.robot, joint.joint);
    };
    std::sort(joints.begin(), joints.end(),
              [&](const JointTrend& a, const JointTrend& b) { return key(a) < key(b); });
}

}  // namespace ripplenotch
