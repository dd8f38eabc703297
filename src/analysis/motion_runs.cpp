// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/motion_runs.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "ripplenotch/analysis/steady.hpp"

namespace ripplenotch {
namespace {

constexpr double smoothing_s = 0.05;

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
    OutputAngle angle{integrated_velocity(log), false};
    if (!log.has_position() || log.size() == 0) return angle;
    std::vector<double> position = unwrapped_position(log);
    double product = 0.0, square = 0.0;
    constexpr std::size_t pieces = 200;
    for (std::size_t b = 0; b < pieces; ++b) {
        const std::size_t from = (log.size() - 1) * b / pieces, to = (log.size() - 1) * (b + 1) / pieces;
        const double moved = angle.turns[to] - angle.turns[from];
        product += moved * (position[to] - position[from]);
        square += moved * moved;
    }
    if (product < 0.5 * square || product > 2.0 * square) return angle;
    return {std::move(position), true};
}

std::vector<double> smoothed_speed(const TraceView& log) {
    const auto width = static_cast<std::size_t>(smoothing_s * log.sample_rate.value()) | 1U;
    return moving_mean(log.velocity_deg_s, width);
}

std::vector<SampleRun> directed_runs(std::span<const double> time_s, std::span<const double> speed_deg_s,
                                     Hertz sample_rate, const RunRule& rule) {
    double fastest = 0.0;
    for (const double v : speed_deg_s) fastest = std::max(fastest, std::abs(v));
    const double slowest = std::max(rule.slowest_deg_s, rule.slowest_share * fastest);
    const double gap = rule.gap_steps / sample_rate.value();
    std::vector<SampleRun> runs;
    int direction = 0;
    for (std::size_t k = 0; k < time_s.size(); ++k) {
        const int here = speed_deg_s[k] > slowest ? 1 : speed_deg_s[k] < -slowest ? -1 : 0;
        const bool jumped = k > 0 && time_s[k] - time_s[k - 1] > gap;
        if (here != 0 && (here != direction || jumped)) runs.push_back({k, k});
        if (here != 0) runs.back().end = k + 1;
        direction = here;
    }
    return runs;
}

std::vector<SampleRun> gapless_runs(std::span<const double> time_s, Hertz sample_rate, double gap_steps) {
    const double gap = gap_steps / sample_rate.value();
    std::vector<SampleRun> runs;
    for (std::size_t k = 0; k < time_s.size(); ++k) {
        if (k == 0 || time_s[k] - time_s[k - 1] > gap) runs.push_back({k, k});
        runs.back().end = k + 1;
    }
    return runs;
}

}  // namespace ripplenotch
