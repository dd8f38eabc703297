// SPDX-License-Identifier: MIT
#include "ripplenotch/evaluate/filter_metrics.hpp"

#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

std::optional<double> attenuation_db(const OrderLevel& level) {
    const double raw = level.amplitude_nm[0], filtered = level.amplitude_nm[1];
    if (!(raw > 0.0) || !(filtered > 0.0)) return std::nullopt;
    return 20.0 * portable::log10(raw / filtered);
}

std::optional<double> predicted_nm(const FilterMetrics& metrics, std::size_t order) {
    if (!metrics.levels) return std::nullopt;
    const OrderLevel& level = metrics.levels->orders[order];
    if (!level.expected_gain) return std::nullopt;
    const std::vector<double>& known_nm = metrics.gear->amplitude_nm;
    const double before = known_nm.empty() ? level.amplitude_nm[0] : known_nm[order];
    return before * *level.expected_gain;
}

}  // namespace ripplenotch
