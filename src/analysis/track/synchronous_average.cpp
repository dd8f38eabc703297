// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/synchronous_average.hpp"

#include <cmath>
#include <limits>

#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

TurnAverage average_turn(std::span<const double> turns, std::span<const double> torque_nm,
                         std::size_t parts) {
    if (parts < 2) raise<UsageError>("a turn is averaged in at least 2 parts, not {}", parts);
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    TurnAverage average;
    average.torque_nm.assign(parts, 0.0);
    average.standard_error_nm.assign(parts, nan);
    average.samples.assign(parts, 0);
    std::vector<double> square(parts, 0.0);  // of deviations from the running mean, by Welford's update
    for (std::size_t k = 0; k < turns.size(); ++k) {
        if (k > 0) average.turns += std::abs(turns[k] - turns[k - 1]);
        const double share = turns[k] - std::floor(turns[k]);
        const auto part = static_cast<std::size_t>(std::lround(share * static_cast<double>(parts))) % parts;
        const double count = static_cast<double>(++average.samples[part]);
        const double deviation = torque_nm[k] - average.torque_nm[part];
        average.torque_nm[part] += deviation / count;
        square[part] += deviation * (torque_nm[k] - average.torque_nm[part]);
    }
    for (std::size_t part = 0; part < parts; ++part) {
        const double count = static_cast<double>(average.samples[part]);
        average.angle_deg.push_back(360.0 * static_cast<double>(part) / static_cast<double>(parts));
        if (count == 0.0) average.torque_nm[part] = nan;
        if (count > 1.0) average.standard_error_nm[part] = std::sqrt(square[part] / (count * (count - 1.0)));
    }
    return average;
}

}  // namespace ripplenotch
