// SPDX-License-Identifier: MIT
#include "ripplenotch/arm/arm_travel.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

// A position this many times beyond the limits in this part of the rows is in another unit.
constexpr double times_beyond = 3.0, part_of_rows = 0.1;
constexpr double few_told = 0.5;  // of the values that there are

void check_unit(const ChainJoint& joint, const TraceView& log, const std::string& name) {
    if (!joint.limits || joint.kind == JointKind::prismatic) return;
    const double most =
        times_beyond * std::max(std::abs(joint.limits->first), std::abs(joint.limits->second));
    const auto beyond = std::count_if(log.position_deg.begin(), log.position_deg.end(),
                                      [&](double position) { return std::abs(position) > most; });
    if (static_cast<double>(beyond) <= part_of_rows * static_cast<double>(log.size())) return;
    double farthest = 0.0;
    for (const double position : log.position_deg) farthest = std::max(farthest, std::abs(position));
    raise<DataError>(
        "arm: position of '{}' reaches {:.3g} rad ({:.4g} deg), and joint '{}' goes to {:.4g} deg; is it in "
        "deg? --unit position=deg",
        name, farthest * std::numbers::pi / 180.0, farthest, joint.name,
        std::max(std::abs(joint.limits->first), std::abs(joint.limits->second)));
}

}  // namespace

std::vector<JointTravel> arm_travel(const Chain& chain, const ArmLog& log,
                                    const std::vector<std::string>& log_joints) {
    std::vector<JointTravel> travel;
    for (std::size_t j = 0; j < chain.size(); ++j) {
        const auto& position = log.joints[j].position_deg;
        check_unit(chain.joints[j], log.joints[j], log_joints[j]);
        const auto [low, high] = std::minmax_element(position.begin(), position.end());
        travel.push_back({chain.joints[j].name, log_joints[j], position.empty() ? 0.0 : *high - *low});
    }
    return travel;
}

std::vector<std::string> arm_warnings(const ArmFit& fit, const std::vector<JointTravel>& travel) {
    std::vector<std::string> still, warnings;
    for (const JointTravel& joint : travel)
        if (joint.travel_deg < least_travel_deg) still.push_back(fmt::format("'{}'", joint.log));
    const std::string names = fmt::format("{}", fmt::join(still, ", "));
    if (static_cast<double>(fit.values_told) < few_told * static_cast<double>(fit.values_there)) {
        warnings.push_back(fmt::format(
            "arm: {} of {} values can be told from this log{}; a motion of all joints "
            "tells more",
            fit.values_told, fit.values_there,
            still.empty() ? ""
                          : fmt::format(", in which {} hardly move{}", names, still.size() == 1 ? "s" : "")));
    } else if (!still.empty()) {
        warnings.push_back(fmt::format(
            "arm: {} move{} less than {:g} deg; the inertia of {} cannot be told apart", names,
            still.size() == 1 ? "s" : "", least_travel_deg, still.size() == 1 ? "its link" : "their links"));
    }
    return warnings;
}

}  // namespace ripplenotch
