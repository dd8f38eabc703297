// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/identification.hpp"

#include <algorithm>

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

}  // namespace ripplenotch
