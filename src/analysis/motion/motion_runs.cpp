// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/motion_runs.hpp"

#include <algorithm>
#include <cmath>

#include "ripplenotch/analysis/steady.hpp"

namespace ripplenotch {
namespace {

constexpr double smoothing_s = 0.05;  // as models smooth speeds (measured_motion.hpp)

std::vector<double> integrated_velocity(const TraceView& log) {
    std::vector<double> turns(log.size(), 0.0);
    for (std::size_t k = 1; k < log.size(); ++k) {
        const double step = log.time_s[k] - log.time_s[k - 1];
        turns[k] = turns[k - 1] + 0.5 * (log.velocity_deg_s[k] + log.velocity_deg_s[k - 1]) * step / 360.0;
    }
    return turns;
}

/// Position in turns, jumps of more than half a turn between neighbours taken as wrapping.
std::vector<double> unwrapped_position(const TraceView& log) {
    std::vector<double> turns(log.size());
    double offset = 0.0;
    for (std::size_t k = 0; k < log.size(); ++k) {
        if (k > 0) {
            const double jump = log.position_deg[k] - log.position_deg[k - 1];
            if (std::abs(jump) > 180.0) offset -= std::round(jump / 360.0);
        }
        turns[k] = log.position_deg[k] / 360.0 + offset;
    }
    return turns;
}

}  // namespace

OutputAngle output_angle(const TraceView& log) {
    if (log.has_position()) return {unwrapped_position(log), true};
    return {integrated_velocity(log), false};
}

std::vector<double> smoothed_speed(const TraceView& log) {
    const auto width = static_cast<std::size_t>(smoothing_s * log.sample_rate.value()) | 1U;
    return moving_mean(log.velocity_deg_s, width);
}

std::vector<SampleRun> directed_runs(std::span<const double> speed_deg_s,
                                     std::span<const std::size_t> run_starts, const RunRule& rule) {
    double fastest = 0.0;
    for (const double v : speed_deg_s) fastest = std::max(fastest, std::abs(v));
    const double slowest = std::max(rule.slowest_share * fastest, rule.standstill_deg_s);
    std::vector<SampleRun> runs;
    auto start = run_starts.begin();
    int direction = 0;
    for (std::size_t k = 0; k < speed_deg_s.size(); ++k) {
        const int here = speed_deg_s[k] > slowest ? 1 : speed_deg_s[k] < -slowest ? -1 : 0;
        const bool begins = start != run_starts.end() && *start == k;
        start += begins ? 1 : 0;
        if (here != 0 && (here != direction || begins)) runs.push_back({k, k});
        if (here != 0) runs.back().end = k + 1;
        direction = here;
    }
    return runs;
}

std::vector<SampleRun> whole_runs(std::size_t samples, std::span<const std::size_t> run_starts) {
    std::vector<SampleRun> runs;
    std::size_t first = 0;
    for (const std::size_t start : run_starts) {
        runs.push_back({first, start});
        first = start;
    }
    if (first < samples) runs.push_back({first, samples});
    return runs;
}

}  // namespace ripplenotch
