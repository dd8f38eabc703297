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

std::vector<double> undecided_ratios(const GearRatioFit& fit) {
    constexpr double probable = 0.2, beside_it = 0.1;  // by hand: the first of all, the others of the first
    std::vector<double> ratios;
    if (fit.value || fit.candidates.empty() || fit.candidates.front().score < probable) return ratios;
    for (const RatioCandidate& one : fit.candidates) {
        if (one.score > beside_it * fit.candidates.front().score) ratios.push_back(one.value);
    }
    return ratios.size() > 1 ? ratios : std::vector<double>{};
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
