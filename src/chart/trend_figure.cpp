// SPDX-License-Identifier: MIT
#include "ripplenotch/chart/trend_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "ripplenotch/fleet/features.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t most_joints = 40;
constexpr double seconds_a_day = 86400.0, most_deviations = 8.0;

double day_of(const std::string& date, double origin_s) {
    return (date_seconds(date).value_or(origin_s) - origin_s) / seconds_a_day;
}

double first_second(const Trend& trend) {
    double first = std::numeric_limits<double>::infinity();
    for (const JointTrend& joint : trend.joints)
        if (const auto seconds = date_seconds(joint.from)) first = std::min(first, *seconds);
    return std::isfinite(first) ? first : 0.0;
}

Panel map_panel(const Trend& trend) {
    std::set<std::string> seen;
    std::vector<const JointTrend*> joints;
    for (const JointTrend& joint : trend.joints) {
        if (joint.course.empty() || joints.size() == most_joints) continue;
        joints.push_back(&joint);
        for (const JointMonth& month : joint.course) seen.insert(month.month);
    }
    const std::vector<std::string> months(seen.begin(), seen.end());
    Panel panel;
    panel.title = months.empty() ? "no joint was examined"
                                 : fmt::format("months from {} on; joint 1 differs most", months.front());
    panel.x = {"month", "", PlotScale::whole};
    panel.y = {"joint", "", PlotScale::whole};
    panel.height = 2.0;
    HeatMap map{"farthest descriptor from its baseline", "deviations of a log", PlotScale::linear, 0.0,
                most_deviations};
    for (std::size_t i = 0; i <= std::max<std::size_t>(months.size(), 1); ++i)
        map.x_edges.push_back(static_cast<double>(i) + 0.5);
    for (std::size_t i = 0; i <= std::max<std::size_t>(joints.size(), 1); ++i)
        map.y_edges.push_back(static_cast<double>(i) + 0.5);
    map.cells.assign((map.x_edges.size() - 1) * (map.y_edges.size() - 1),
                     std::numeric_limits<double>::quiet_NaN());
    for (std::size_t row = 0; row < joints.size(); ++row)
        for (const JointMonth& month : joints[row]->course) {
            const auto column = static_cast<std::size_t>(
                std::lower_bound(months.begin(), months.end(), month.month) - months.begin());
            map.cells[row * months.size() + column] = std::abs(month.deviations);
        }
    panel.map = std::move(map);
    return panel;
}

Panel course_panel(const JointTrend& joint, const JointChange& change, double origin_s) {
    Panel panel;
    panel.title = fmt::format("{}: {}", joint.name(), change.cause);
    panel.x = {"day", "", PlotScale::linear};
    panel.y = {change.descriptors.front().name, "", PlotScale::linear};
    Curve curve{"at median conditions", Ink::blue, CurveStyle::points, {}, {}};
    for (const AdjustedValue& value : change.course) {
        curve.x.push_back(day_of(value.date, origin_s));
        curve.y.push_back(value.value);
    }
    panel.curves.push_back(std::move(curve));
    if (!change.drift) {
        panel.shades.push_back({"", Ink::grey, day_of(change.earliest, origin_s),
                                day_of(change.latest, origin_s), -std::numeric_limits<double>::infinity(),
                                std::numeric_limits<double>::infinity()});
        panel.lines.push_back({change.date.substr(0, 10), NamedLine::Run::at_x, day_of(change.date, origin_s),
                               Ink::vermilion, true});
    }
    panel.legend = false;
    return panel;
}

}  // namespace

Figure trend_figure(const Trend& trend) {
    Figure figure{"trend", "What changed in the fleet", "", {map_panel(trend)}, 1};
    const double origin_s = first_second(trend);
    std::size_t alerts = 0, shown = 0;
    for (const JointTrend& joint : trend.joints) {
        for (const JointChange& change : joint.changes) {
            ++alerts;
            if (shown == most_trend_courses || change.course.empty()) continue;
            ++shown;
            figure.panels.push_back(course_panel(joint, change, origin_s));
        }
    }
    figure.sentence = fmt::format("{} alerts in {:.4g} joint-months; days count from {}.", alerts,
                                  trend.joint_months, date_text(origin_s).substr(0, 10));
    return figure;
}

}  // namespace ripplenotch
