// SPDX-License-Identifier: MIT
#include "log/unwrap.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "ripplenotch/core/units.hpp"

namespace ripplenotch {
namespace {

constexpr std::array full_turns = {360.0, 2.0 * std::numbers::pi, 360.0 * degrees_per_radian};

}  // namespace

std::optional<double> wrap_period(std::span<const double> position_deg) {
    if (position_deg.size() < 3) return std::nullopt;
    const auto [low, high] = std::minmax_element(position_deg.begin(), position_deg.end());
    const double range = *high - *low;
    for (const double period : full_turns) {
        // A wrapped angle fills its turn nearly and never exceeds it, and steps over the seam in one row.
        if (range < 0.9 * period || range > 1.0001 * period) continue;
        double largest_other = 0.0;
        bool seam = false;
        for (std::size_t i = 1; i < position_deg.size(); ++i) {
            const double step = std::abs(position_deg[i] - position_deg[i - 1]);
            if (step > 0.5 * period) {
                seam = true;
            } else {
                largest_other = std::max(largest_other, step);
            }
        }
        if (seam && largest_other < 0.25 * period) return period;
    }
    return std::nullopt;
}

void unwrap(std::span<double> position_deg, double period) {
    double turns = 0.0;
    for (std::size_t i = 1; i < position_deg.size(); ++i) {
        const double step = position_deg[i] + turns * period - position_deg[i - 1];
        turns -= std::round(step / period);
        position_deg[i] += turns * period;
    }
}

}  // namespace ripplenotch
