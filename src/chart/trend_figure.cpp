// SPDX-License-Identifier: MIT
#include "ripplenotch/chart/figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "ripplenotch/fleet/features.hpp"

namespace ripplenotch {
namespace {

constexpr double seconds_a_day = 86400.0;

double day_of(const std::string& date, double origin_s) {
    return (date_seconds(date).value_or(origin_s) - origin_s) / seconds_a_day;
}

double first_second(const Trend& trend) {
    double first = std::numeric_limits<double>::infinity();
    for (const JointTrend& joint : trend.joints)
        if (const auto seconds = date_seconds(joint.from)) first = std::min(first, *seconds);
    return std::isfinite(first) ? first : 0.0;
}

Panel course_panel(const JointTrend& joint, const JointChange& change, double origin_s) {
    Panel panel;
    panel.title = joint.name();
    panel.x = {"day", "", PlotScale::linear};
    panel.y = {change.descriptors.front().name, "", PlotScale::linear};
    Curve curve{"at median conditions", Ink::blue, CurveStyle::points, {}, {}};
    for (const AdjustedValue& value : change.course) {
        curve.x.push_back(day_of(value.date, origin_s));
        curve.y.push_back(value.value);
    }
    panel.curves.push_back(std::move(curve));
    if (!change.drift) {
        panel.lines.push_back({change.date.substr(0, 10), NamedLine::Run::at_x, day_of(change.date, origin_s),
                               Ink::vermilion, true});
    }
    panel.legend = false;
    return panel;
}

}  // namespace

Figure trend_figure(const Trend& trend) {
    Figure figure{"trend", "What changed in the fleet", "", {}, 1};
    const double origin_s = first_second(trend);
    std::size_t alerts = 0, shown = 0;
    for (const JointTrend& joint : trend.joints) {
        for (const JointChange& change : joint.changes) {
            ++alerts;
            if (shown == max_trend_courses || change.course.empty()) continue;
            ++shown;
            figure.panels.push_back(course_panel(joint, change, origin_s));
        }
    }
    if (figure.panels.empty()) {
        Panel& none = figure.panels.emplace_back();
        none.title = "no joint changed";
        none.x = {"day", "", PlotScale::linear};
        none.y = {"descriptor", "", PlotScale::linear};
    }
    figure.sentence = fmt::format("{} alerts in {:.4g} joint-months; days count from {}.", alerts,
                                  trend.joint_months, date_text(origin_s).substr(0, 10));
    return figure;
}

}  // namespace ripplenotch
