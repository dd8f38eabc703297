// SPDX-License-Identifier: MIT
#include "log/held_samples.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace ripplenotch {
namespace {

// Steps of the torque are coarse when the usual change is only a few of the smallest: then equality is
// chance.
bool is_coarse(std::span<const double> values, std::span<const char> moving) {
    std::vector<double> changes;
    for (std::size_t i = 1; i < values.size(); ++i) {
        const double change = std::abs(values[i] - values[i - 1]);
        if (moving[i] != 0 && change > 0.0) changes.push_back(change);
    }
    if (changes.size() < 8) return true;
    const double smallest = *std::min_element(changes.begin(), changes.end());
    const auto middle = changes.begin() + static_cast<std::ptrdiff_t>(changes.size() / 2);
    std::nth_element(changes.begin(), middle, changes.end());
    return *middle < 10.0 * smallest;
}

}  // namespace

HeldSamples count_held(const TraceView& trace) {
    HeldSamples held;
    const std::size_t rows = trace.size();
    if (rows < 2 || !std::isfinite(trace.torque_nm[0]) || !std::isfinite(trace.velocity_deg_s[0]))
        return held;
    double fastest = 0.0;
    for (const double speed : trace.velocity_deg_s) fastest = std::max(fastest, std::abs(speed));
    std::vector<char> moving(rows, 0);
    std::size_t moving_rows = 0, velocity_repeats = 0, position_repeats = 0;
    const auto repeats = [](std::span<const double> values, std::size_t i) {
        return values[i] == values[i - 1];
    };
    for (std::size_t i = 1; i < rows; ++i) {
        const double slower =
            std::min(std::abs(trace.velocity_deg_s[i]), std::abs(trace.velocity_deg_s[i - 1]));
        if (!(slower > 0.02 * fastest)) continue;
        moving[i] = 1;
        ++moving_rows;
        velocity_repeats += repeats(trace.velocity_deg_s, i);
        position_repeats += trace.has_position() && repeats(trace.position_deg, i);
    }
    const bool velocity_tells = 2 * velocity_repeats < moving_rows;
    const bool position_tells = trace.has_position() && 2 * position_repeats < moving_rows;
    if (!velocity_tells && !position_tells && is_coarse(trace.torque_nm, moving)) return held;

    std::size_t run = 0;
    for (std::size_t i = 1; i < rows; ++i) {
        const bool same = moving[i] != 0 && repeats(trace.torque_nm, i) &&
                          (!velocity_tells || repeats(trace.velocity_deg_s, i)) &&
                          (!position_tells || repeats(trace.position_deg, i));
        run = same ? run + 1 : 0;
        held.count += same;
        held.longest = std::max(held.longest, run);
    }
    return held;
}

}  // namespace ripplenotch
