// SPDX-License-Identifier: MIT
#include <algorithm>

#include "ripplenotch/analysis/track_report.hpp"

namespace ripplenotch {
namespace {

// A step so much longer than its neighbours holds no data: windows grow and shrink with the speed, but
// slowly.
constexpr double longest_step = 3.0;

}  // namespace

std::vector<std::size_t> track_breaks(const OrderTracks& tracks) {
    const std::vector<double>& time_s = tracks.time_s;
    const std::vector<double>& speed = tracks.speed_deg_s;
    const auto step = [&](std::size_t row) { return time_s[row] - time_s[row - 1]; };
    std::vector<std::size_t> breaks;
    for (std::size_t row = 1; row < time_s.size(); ++row) {
        const bool turned = speed[row] * speed[row - 1] < 0.0;
        double beside = 0.0;
        if (row > 1) beside = std::max(beside, step(row - 1));
        if (row + 1 < time_s.size()) beside = std::max(beside, step(row + 1));
        if (turned || (beside > 0.0 && step(row) > longest_step * beside)) breaks.push_back(row);
    }
    return breaks;
}

std::vector<std::size_t> track_breaks(const SpeedTrack& tracks) {
    const std::vector<double>& speed = tracks.speed_deg_s;
    std::vector<std::size_t> breaks;
    for (std::size_t row = 1; row < speed.size(); ++row) {
        // The mean of a range lies anywhere in it, so that neighbours are less than two widths apart.
        if (speed[row] - speed[row - 1] > 2.0 * tracks.step_deg_s) breaks.push_back(row);
    }
    return breaks;
}

}  // namespace ripplenotch
