// SPDX-License-Identifier: MIT
#include "ripplenotch/design/speed_regions.hpp"

#include <algorithm>
#include <limits>

namespace ripplenotch {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// A range next to a band's edge, under the rule for speeds that no band covers.
SpeedRegion outside(double from, double to, OutsideRule rule, int edge_candidate, double edge,
                    double fade_end) {
    SpeedRegion region{from, to};
    if (rule == OutsideRule::hold) region.holds = true;
    if (rule == OutsideRule::fade) {
        region.candidate = edge_candidate;
        region.full_deg_s = edge;
        region.none_deg_s = fade_end;
    }
    return region;
}

}  // namespace

double SpeedRegion::share(double speed_deg_s) const noexcept {
    if (!fades()) return 1.0;
    return std::clamp((speed_deg_s - none_deg_s) / (full_deg_s - none_deg_s), 0.0, 1.0);
}

std::vector<SpeedRegion> speed_regions(std::span<const std::pair<DegPerSec, DegPerSec>> bands,
                                       OutsideRule below, OutsideRule above) {
    std::vector<SpeedRegion> regions;
    double reached = -infinity;
    for (std::size_t i = 0; i < bands.size(); ++i) {
        const double from = bands[i].first.value(), to = bands[i].second.value();
        const int candidate = static_cast<int>(i);
        if (i == 0) {
            regions.push_back(outside(reached, from, below, candidate, from, from / 2.0));
        } else if (from > reached) {
            // Each half of a hole belongs to the band it touches; with `fade` both are at 0 where they meet.
            const double middle = (reached + from) / 2.0;
            regions.push_back(outside(reached, middle, below, candidate - 1, reached, middle));
            regions.push_back(outside(middle, from, below, candidate, from, middle));
        }
        regions.push_back({from, to, candidate});
        reached = to;
    }
    const int last = static_cast<int>(bands.size()) - 1;
    regions.push_back(outside(reached, infinity, above, last, reached, 1.5 * reached));
    return regions;
}

std::vector<SpeedRegion> speed_regions(std::span<const Band> bands, OutsideRule below, OutsideRule above) {
    std::vector<std::pair<DegPerSec, DegPerSec>> edges;
    for (const Band& band : bands) edges.emplace_back(band.from, band.to);
    return speed_regions(edges, below, above);
}

}  // namespace ripplenotch
