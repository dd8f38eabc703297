// SPDX-License-Identifier: MIT
#include "fleet/trend/courses.hpp"

#include <algorithm>
#include <cmath>
#include <map>

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

}  // namespace ripplenotch
