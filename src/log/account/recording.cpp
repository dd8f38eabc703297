// SPDX-License-Identifier: MIT
#include "ripplenotch/log/recording.hpp"

#include <fmt/format.h>

#include "ripplenotch/core/percent.hpp"

namespace ripplenotch {

std::vector<LogWarning> recording_warnings(const Recording& recording, const std::string& clock_check) {
    std::vector<LogWarning> warnings = clock_warnings(recording.clock);
    const double held = 100.0 * static_cast<double>(recording.held.count) /
                        static_cast<double>(recording.rows() > 0 ? recording.rows() : 1);
    if (held >= 0.1) {
        warnings.push_back(
            {"held samples",
             fmt::format("{} rows ({} %) hold the sample before while the joint moves, up to {} in a row",
                         recording.held.count, percent_text(held), recording.held.longest),
             true});
    }
    using Verdict = AngleFacts::Verdict;
    const Verdict verdict = recording.angle.verdict;
    if (const std::string angle = recording.angle.warning(); !angle.empty())
        warnings.push_back({"angle", angle, true});
    if ((verdict == Verdict::agrees || verdict == Verdict::too_little_motion) && !clock_check.empty())
        warnings.push_back({"clock against motion", clock_check, true});
    return warnings;
}

}  // namespace ripplenotch
