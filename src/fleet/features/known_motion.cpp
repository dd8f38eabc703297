// SPDX-License-Identifier: MIT
#include "fleet/features/known_motion.hpp"

#include <algorithm>
#include <cmath>

#include "model/local_motion.hpp"
#include "ripplenotch/core/median.hpp"
#include "ripplenotch/model/measured_motion.hpp"

namespace ripplenotch {
namespace {

constexpr double jump_deviations = 8.0, jump_part = 0.02;

}  // namespace

std::vector<unsigned char> rows_of_known_motion(const TraceView& log, const Motion& motion) {
    std::vector<double> speeds;
    for (const double speed : motion.velocity_deg_s) speeds.push_back(std::abs(speed));
    const double most_deg_s =
        std::max(jump_deviations * sample_noise(log.velocity_deg_s), jump_part * median_in(speeds));
    std::vector<unsigned char> known(log.size(), 1);
    const double window_s = default_smoothing.value();
    std::size_t from = 0, until = 0;  // `until`: rows before it are settled
    for (std::size_t k = 0; k < log.size(); ++k) {
        if (!(std::abs(log.velocity_deg_s[k] - motion.velocity_deg_s[k]) > most_deg_s)) continue;
        while (log.time_s[k] - log.time_s[from] > window_s) ++from;
        until = std::max(until, from);
        while (until < log.size() && log.time_s[until] - log.time_s[k] <= window_s) known[until++] = 0;
    }
    return known;
}

}  // namespace ripplenotch
