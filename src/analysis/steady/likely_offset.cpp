// SPDX-License-Identifier: MIT
#include "analysis/steady/likely_offset.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr int offsets_a_side = 60;   // to either side, each a twentieth of the likely share
constexpr double per_step = 0.05;    // as many offsets_a_side reach three times the likely share
constexpr double apart_share = 0.1;  // by hand: as far apart an order and a tone stay two at any offset
constexpr std::size_t most_stretches = 40;  // by hand: for a start, whose cost grows with their square
constexpr std::size_t clearest_few = 3;     // by hand: lines of a stretch that are compared

std::vector<Sighting> clearest_of_each(std::span<const Sighting> sightings) {
    std::map<std::size_t, std::vector<Sighting>> by_stretch;
    for (const Sighting& seen : sightings) {
        if (seen.by_velocity && seen.speed_deg_s != 0.0) by_stretch[seen.stretch].push_back(seen);
    }
    std::vector<Sighting> kept;
    const std::size_t every = (by_stretch.size() + most_stretches - 1) / most_stretches;
    std::size_t place = 0;
    for (auto& [stretch, lines] : by_stretch) {
        if (place++ % every != 0) continue;
        std::stable_sort(lines.begin(), lines.end(),
                         [](const Sighting& a, const Sighting& b) { return a.snr > b.snr; });
        lines.resize(std::min(lines.size(), clearest_few));
        kept.insert(kept.end(), lines.begin(), lines.end());
    }
    return kept;
}

/// Two sightings at different speeds: how far apart their orders are in their logarithm, how that changes
/// with an offset, and its standard error.
struct OffsetPair {
    double apart = 0.0, per_deg_s = 0.0, error = 0.0;
};

std::vector<OffsetPair> pairs_of(std::span<const Sighting> sightings, double step) {
    std::vector<OffsetPair> pairs;
    for (std::size_t i = 0; i < sightings.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            const Sighting &a = sightings[i], &b = sightings[j];
            const double fast = std::max(std::abs(a.speed_deg_s), std::abs(b.speed_deg_s));
            if (a.stretch == b.stretch ||
                std::abs(std::abs(a.speed_deg_s) - std::abs(b.speed_deg_s)) < apart_share * fast)
                continue;
            OffsetPair pair;
            pair.apart = portable::log(a.order_output() / b.order_output());
            pair.per_deg_s = 1.0 / a.speed_deg_s - 1.0 / b.speed_deg_s;
            // A step of the search is no error, but what lies within one is found.
            pair.error =
                portable::hypot(portable::hypot(a.hz_error / a.hz, b.hz_error / b.hz, step * pair.per_deg_s),
                                a.speed_share_error, b.speed_share_error);
            pairs.push_back(pair);
        }
    }
    return pairs;
}

}  // namespace

bool speeds_tell_offset(std::vector<double> signed_deg_s) {
    constexpr std::size_t fewest_speeds = 3;  // two agree on an order at some offset, whatever they are
    std::sort(signed_deg_s.begin(), signed_deg_s.end());
    std::size_t count = 0;
    double last = 0.0;
    for (const double speed : signed_deg_s) {
        if (count > 0 && speed - last <= apart_share * std::abs(speed)) continue;
        last = speed;
        ++count;
    }
    return count >= fewest_speeds;
}

DegPerSec likely_offset(std::span<const Sighting> sightings) {
    const std::vector<Sighting> seen = clearest_of_each(sightings);
    std::vector<double> speeds;
    double fastest = 0.0;
    for (const Sighting& one : seen) {
        speeds.push_back(one.speed_deg_s);
        fastest = std::max(fastest, std::abs(one.speed_deg_s));
    }
    if (!speeds_tell_offset(std::move(speeds))) return DegPerSec(0.0);
    const double step = per_step * likely_offset_share * fastest;
    const std::vector<OffsetPair> pairs = pairs_of(seen, step);
    double best = 0.0, most = -1e300;
    for (int k = -offsets_a_side; k <= offsets_a_side; ++k) {
        const double share = per_step * k;
        double agreement = -0.5 * share * share;
        for (const OffsetPair& pair : pairs) {
            const double off = (pair.apart + k * step * pair.per_deg_s) / pair.error;
            agreement += portable::exp(-0.5 * off * off);
        }
        if (agreement > most) {
            most = agreement;
            best = k * step;
        }
    }
    return DegPerSec(best);
}

}  // namespace ripplenotch
