// SPDX-License-Identifier: MIT
#include "export/map/map_target.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/export/target.hpp"

namespace ripplenotch {

namespace {

constexpr const MapTarget* every_map_target[] = {
#define MAP_TARGET(name) &map_target_list::name,
#include "export/map_targets/map_targets.def"
#undef MAP_TARGET
};

// Places of the motor that no harmonic and no table repeats: multiples of the golden section.
constexpr double golden_turns = 0.6180339887498949;
constexpr int places = 2000;

}  // namespace

std::span<const MapTarget* const> map_targets() { return every_map_target; }

const MapTarget& find_map_target(std::string_view name) {
    return find_entry(map_targets(), "map export target", "targets", name);
}

MapCheck verify_map_export(const RippleMap& map, const LoadedMap& loaded) {
    MapCheck check;
    const double span_deg =
        std::max(map.positions_deg.to - map.positions_deg.from, 360.0 / map.gear_ratio.value());
    double ripple = 0.0, not_held = 0.0;
    for (const double speed : {map.speeds_deg_s.from, map.speeds_deg_s.middle(), map.speeds_deg_s.to}) {
        for (const double sign : {1.0, -1.0}) {
            double share = 0.0;
            for (int k = 0; k < places; ++k) {
                share += golden_turns;
                share -= std::floor(share);
                const MapState state{sign * speed, map.positions_deg.from + share * span_deg};
                const double whole = map_torque(map, state), held = map_torque(loaded.held, state);
                ripple += whole * whole;
                not_held += (whole - held) * (whole - held);
                check.largest_error_nm =
                    std::max(check.largest_error_nm, std::abs(loaded.torque_nm(state) - held));
                ++check.states;
            }
        }
    }
    const double count = static_cast<double>(check.states);
    check.ripple_nm = std::sqrt(ripple / count);
    check.not_held_nm = std::sqrt(not_held / count);
    return check;
}

}  // namespace ripplenotch
