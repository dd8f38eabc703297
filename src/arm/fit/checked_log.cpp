// SPDX-License-Identifier: MIT
#include "arm/fit/checked_log.hpp"

#include <algorithm>
#include <cmath>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/model/measured_motion.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t fewest_rows = 100;  // by hand
constexpr double rest_s = 1.0;            // by hand: of a rest, what is used

void check_sizes(const Chain& chain, const ArmLog& log, const ArmFitOptions& options) {
    if (log.joints.size() != chain.size() || log.has_torque.size() != chain.size())
        raise<UsageError>("arm: {} joints of a log for {} of {}", log.joints.size(), chain.size(),
                          chain.source);
    const std::size_t rows = log.joints.front().size();
    for (std::size_t j = 0; j < chain.size(); ++j) {
        const TraceView& joint = log.joints[j];
        if (joint.size() != rows || !joint.has_position())
            raise<UsageError>("arm: joint '{}' has {} rows{}, others have {}", chain.joints[j].name,
                              joint.size(), joint.has_position() ? "" : " without position", rows);
    }
    if (!options.use.empty() && options.use.size() != rows)
        raise<UsageError>("arm: {} marks for {} rows", options.use.size(), rows);
}

void check_numbers(const Chain& chain, const CheckedLog& checked) {
    for (std::size_t j = 0; j < chain.size(); ++j) {
        const TraceView& joint = checked.log.joints[j];
        const bool torque =
            std::find(checked.fitted.begin(), checked.fitted.end(), j) != checked.fitted.end();
        for (std::size_t k = 0; k < joint.size(); ++k) {
            const bool finite = std::isfinite(joint.position_deg[k]) &&
                                std::isfinite(joint.velocity_deg_s[k]) &&
                                (!torque || std::isfinite(joint.torque_nm[k]));
            if (!finite)
                raise<DataError>("arm: joint '{}' holds a number that is not finite in row {}",
                                 chain.joints[j].name, k + 1);
        }
    }
}

void leave_out_long_rests(CheckedLog& checked) {
    const auto& time_s = checked.log.joints.front().time_s;
    std::size_t since = 0;
    for (std::size_t k = 0; k < time_s.size(); ++k) {
        const bool rests = std::all_of(checked.friction.begin(), checked.friction.end(),
                                       [&](const Motion& joint) { return joint.velocity_deg_s[k] == 0.0; });
        if (!rests) since = k + 1;
        if (rests && time_s[k] - time_s[since] > rest_s) checked.use[k] = false;
    }
}

}  // namespace

CheckedLog check_log(const Chain& chain, const ArmLog& log, const ArmFitOptions& options) {
    check_sizes(chain, log, options);
    CheckedLog checked{log, {}, options.joints, options.use};
    for (std::size_t j = 0; j < chain.size(); ++j)
        if (options.joints.empty() && log.has_torque[j]) checked.fitted.push_back(j);
    if (checked.fitted.empty())
        raise<UsageError>("arm: no joint of {} has a torque in the log", chain.source);
    for (const std::size_t joint : checked.fitted) {
        if (joint >= chain.size() || !log.has_torque[joint])
            raise<UsageError>("arm: joint {} of {} has no torque in the log", joint + 1, chain.source);
    }
    check_numbers(chain, checked);
    checked.friction = arm_motions(log, default_smoothing);
    const bool moves = std::any_of(checked.friction.begin(), checked.friction.end(), [](const Motion& joint) {
        return std::any_of(joint.velocity_deg_s.begin(), joint.velocity_deg_s.end(),
                           [](double v) { return v != 0.0; });
    });
    if (!moves) raise<DataError>("arm: no joint moves; the log tells next to nothing of the arm");
    if (checked.use.empty()) checked.use.assign(log.joints.front().size(), true);
    leave_out_long_rests(checked);
    const auto rows = static_cast<std::size_t>(std::count(checked.use.begin(), checked.use.end(), true));
    if (rows < fewest_rows)
        raise<DataError>("arm: {} rows count for the fit, expected {} or more", rows, fewest_rows);
    return checked;
}

}  // namespace ripplenotch
