// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/identification.hpp"

#include <algorithm>
#include <utility>

namespace ripplenotch {

std::string_view line_kind_name(LineKind kind) {
    switch (kind) {
        case LineKind::order:
            return "order";
        case LineKind::tone:
            return "tone";
        case LineKind::alias:
            return "alias";
        case LineKind::unknown:
            return "unknown";
    }
    return "unknown";
}

std::optional<SeenFrequencies> seen_frequencies(const Line& line) {
    if (line.hz) return SeenFrequencies{*line.hz, *line.hz};
    if (line.by_speed.empty()) return std::nullopt;
    const auto [lowest, highest] =
        std::minmax_element(line.by_speed.begin(), line.by_speed.end(),
                            [](const AmplitudeAtSpeed& a, const AmplitudeAtSpeed& b) { return a.hz < b.hz; });
    return SeenFrequencies{lowest->hz, highest->hz};
}

std::optional<double> motor_order(const Line& line) {
    const bool follows = line.kind == LineKind::order || line.kind == LineKind::unknown;
    return follows ? line.order : std::nullopt;
}

std::optional<GearAccount> found_gear(const Identification& found) {
    if (!found.gear_ratio.value) return std::nullopt;
    std::vector<Order> orders;
    for (const Line& line : found.lines) {
        if (const auto order = motor_order(line)) orders.emplace_back(*order);
    }
    std::sort(orders.begin(), orders.end());
    orders.erase(std::unique(orders.begin(), orders.end()), orders.end());
    return GearAccount{GearRatio(*found.gear_ratio.value), std::move(orders), {}, {}, "found in the log"};
}

}  // namespace ripplenotch
