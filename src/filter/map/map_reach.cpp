// SPDX-License-Identifier: MIT
#include "filter/map/map_reach.hpp"

#include <cmath>

#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

// The speeds of a map are means over its windows, where the joint moved evenly: peaks of the same motion are
// a quarter above them on a robot.
constexpr double faster_than_seen = 1.5;

}  // namespace

MapReach::MapReach(std::string_view method, const Settings& settings, double sample_rate_hz)
    : method_(method),
      slowest_deg_s_(settings.number("slowest")),
      deg_s_a_turn_a_sample_(360.0 / settings.number("gear-ratio") * sample_rate_hz) {
    if (settings.has("fastest") && settings.text("beyond") == "refuse")
        fastest_deg_s_ = settings.number("fastest");
}

void MapReach::judge() {
    const double speed_deg_s = std::abs(turned_) / samples_ * deg_s_a_turn_a_sample_;
    if (speed_deg_s > faster_than_seen * fastest_deg_s_) {
        raise<DataError>(
            "method {}: its map was made at {:.3g} to {:.3g} deg/s, and this joint moves at {:.3g} deg/s: it "
            "is "
            "the map of another joint, or of too slow logs; beyond=hold takes its edge there",
            method_, slowest_deg_s_, fastest_deg_s_, speed_deg_s);
    }
    restart();
}

}  // namespace ripplenotch
