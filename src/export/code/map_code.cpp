// SPDX-License-Identifier: MIT
#include "export/code/map_code.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <complex>
#include <iterator>

#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/design/running_design.hpp"

namespace ripplenotch {
namespace {

constexpr double slowest_blend_deg_s = 0.1;

// The joint position that its angle is counted from: the middle of what was seen, or the map's zero.
double counted_from_deg(const RippleMap& map) {
    const MapRange& seen = map.positions_deg;
    return seen.to > seen.from ? seen.middle() : map.zero_deg;
}

// The same amplitudes with the second comb's columns as orders of their own behind the first comb's. The map
// itself where it has no second comb.
RippleMap with_combs_apart(const RippleMap& map) {
    if (map.form.second_comb == 0) return map;
    RippleMap apart = map;
    apart.form.second_comb = 0;
    apart.orders.insert(apart.orders.end(), map.orders.begin(), map.orders.end());
    const std::size_t knots = map.form.speeds_deg_s.size();
    apart.values.assign(apart.orders.size(), {});
    for (std::size_t i = 0; i < map.orders.size(); ++i) {
        const std::complex<double> turned = second_comb_phasor(map, i, counted_from_deg(map));
        for (std::size_t c = 0; c < map.form.columns(); ++c) {
            if (map.form.is_second_comb(c)) continue;
            apart.values[i].push_back(map.values[i][c]);
            apart.values[map.orders.size() + i].push_back(turned * map.values[i][c + knots]);
        }
    }
    return apart;
}

}  // namespace

MapTables::MapTables(const RippleMap& stated) : speeds(stated.form.speeds_deg_s) {
    const RippleMap map = with_combs_apart(stated);
    for (std::size_t k = 0; k + 1 < std::max<std::size_t>(speeds.size(), 2); ++k) {
        const double gap = speeds.size() > 1 ? speeds[k + 1] - speeds[k] : 0.0;
        slopes.push_back(gap > 0.0 ? 1.0 / gap : 0.0);
        offsets.push_back(gap > 0.0 ? -0.5 * (speeds[k] + speeds[k + 1]) / gap : 0.0);
    }
    limits = {std::max(map.speeds_deg_s.from, slowest_blend_deg_s), -counted_from_deg(map) / 360.0};
    const std::size_t each = map.form.columns_a_direction();
    for (std::size_t d = 0; d < map.form.directions; ++d) {
        for (std::size_t k = 0; k + 1 < speeds.size(); ++k) {
            const std::size_t c = d * each + k;
            add(map, [c](const auto& z) { return 0.5 * (z[c] + z[c + 1]); });
            add(map, [c](const auto& z) { return z[c + 1] - z[c]; });
        }
        if (speeds.size() == 1) add(map, [at = d * each](const auto& z) { return z[at]; });
    }
}

template <class Of>
void MapTables::add(const RippleMap& map, const Of& of) {
    for (const auto& order : map.values) {
        amplitudes.push_back(of(order).real());
        amplitudes.push_back(of(order).imag());
    }
}

std::size_t MapTables::columns_a_direction(const MapForm& form) {
    const std::size_t speeds = form.speeds_deg_s.size();
    return speeds > 1 ? 2 * (speeds - 1) : 1;
}

MapTables::MapTables(TextReader& reader, const RippleMap& map, const CodeStyle& style)
    : speeds(style.read(reader, "speeds", map.form.speeds_deg_s.size())),
      slopes(style.read(reader, "slopes", std::max<std::size_t>(speeds.size(), 2) - 1)),
      offsets(style.read(reader, "offsets", slopes.size())),
      limits(style.read(reader, "limits", 2)),
      amplitudes(style.read(reader, "amplitudes", MapTables(map).amplitudes.size())) {}

std::string map_code(const RippleMap& map, const CodeStyle& style) {
    const MapForm& form = map.form;
    const MapTables tables(map);
    return fmt::format(
               "\n/* the map: RN_PARTS amplitudes at RN_SPEEDS speeds; rn_limits: the slowest speed, below "
               "which "
               "the directions run\n   into each other, and where the joint's angle counts from */\nenum {{ "
               "RN_PARTS = {}, RN_SPEEDS = {}, RN_DIRECTIONS = {}, RN_COLUMNS = {}, RN_SECOND_COMB = {} "
               "}};\n",
               2 * map.orders.size() * (form.second_comb != 0 ? 2 : 1), form.speeds_deg_s.size(),
               form.directions, MapTables::columns_a_direction(form), form.second_comb) +
           style.array("speeds", tables.speeds) + style.array("slopes", tables.slopes) +
           style.array("offsets", tables.offsets) + style.array("limits", tables.limits) +
           style.array("amplitudes", tables.amplitudes) + std::string(runtime_text::map);
}

std::string by_shaft(std::string code, const std::vector<double>& orders, GearRatio ratio) {
    if (ratio == no_ratio)
        code = filled(std::move(code), {{"motor's", "joint's"}, {"motor_turns", "joint_turns"}});
    if (repeats_each_turn(orders)) return code;
    return filled(std::move(code), {{"the fraction of the turn is enough",
                                     "whole turns count, for not every order is whole"}});
}

std::vector<int> halves_of(const std::vector<double>& orders) {
    std::vector<int> halves;
    for (const double order : orders) {
        const auto half = std::find(orders.begin(), orders.begin() + std::ssize(halves), 0.5 * order);
        const auto at = static_cast<int>(half - orders.begin());
        halves.push_back(at < std::ssize(halves) ? at : -1);
    }
    return halves;
}

std::string angles_code(const std::vector<double>& orders, const CodeStyle& style) {
    return style.array("orders", orders) + fmt::format("static const int rn_half[{}] = {{{}}};\n",
                                                       orders.size(), fmt::join(halves_of(orders), ", "));
}

}  // namespace ripplenotch
