// SPDX-License-Identifier: MIT
#include "export/code/map_code.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <complex>

#include "export/run/map_run.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/design/running_design.hpp"

namespace ripplenotch {
namespace {

constexpr double slowest_blend_deg_s = 0.1;

// From -0.5 to 0.5 between two speeds.
constexpr std::string_view along_code = R"c(    const @real@ size = @abs@(speed_deg_s);
    @real@ along;
    int at = 0;
    while (at + 2 < @speeds@ && @name@_speeds[at + 1] < size) ++at;
    along = @name@_fma(size, @name@_slopes[at], @name@_offsets[at]);
    if (@abs@(along) > (@real@)0.5) along = along < 0 ? (@real@)-0.5 : (@real@)0.5;
)c";

// The joint position that its angle is counted from: the middle of what was seen, or the map's zero.
double counted_from_deg(const RippleMap& map) {
    const MapRange& seen = map.positions_deg;
    return seen.to > seen.from ? seen.middle() : map.zero_deg;
}

}  // namespace

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

std::string MapCode::arguments(bool with_types) const {
    const MapForm& form = map_.form;
    std::string text;
    const auto add = [&](bool is, std::string_view name, std::string_view value) {
        if (is) text += with_types ? fmt::format("@real@ {}, ", name) : fmt::format("{}, ", value);
    };
    add(form.speeds_deg_s.size() > 1 || form.directions > 1, "speed_deg_s", "speed_deg_s");
    add(by_joint(), "joint_deg", "joint_deg");
    return text;
}

std::string MapCode::amplitudes_here() const {
    std::string text;
    if (map_.form.speeds_deg_s.size() == 1 && map_.form.directions == 1) text += "    (void)speed_deg_s;\n";
    if (!by_joint()) text += "    (void)joint_deg;\n";
    if (is_constant()) return text + "    const @real@* const z = @name@_amplitudes;\n";
    return text + fmt::format("    @real@ z[{}];\n    @name@_at({}z);\n", 2 * apart_.orders.size(),
                              arguments(false));
}

// A cosine or sine amplitude, as MapRun adds it up.
std::string MapCode::sum(std::size_t part) const {
    const MapForm& form = apart_.form;
    const std::size_t parts = 2 * apart_.orders.size(), speeds = form.speeds_deg_s.size();
    if (speeds == 1) return fmt::format("v[{}]", part);
    const std::array products = {
        std::pair<std::string, std::string>("along", fmt::format("low[{}]", part + parts))};
    return sum_code(fmt::format("low[{}]", part), products);
}

// The amplitudes of one direction, formatted by `form`: {0} their index, {1} their value.
std::string MapCode::side(std::size_t direction, std::string_view indent, std::string_view form) const {
    const std::size_t parts = 2 * apart_.orders.size();
    std::string text = fmt::format("{}const @real@* const v = @name@_amplitudes + {};\n", indent,
                                   direction * parts * MapTables::columns_a_direction(apart_.form));
    if (map_.form.speeds_deg_s.size() > 1)
        text += fmt::format("{}const @real@* const low = v + {} * at;\n", indent, 2 * parts);
    for (std::size_t i = 0; i < parts; ++i)
        text += fmt::format("{}{}\n", indent, fmt::format(fmt::runtime(form), i, sum(i)));
    return text;
}

// The amplitudes of the second comb, turned by the joint's angle, added to those of the first.
std::string MapCode::combined() const {
    const std::size_t orders = map_.orders.size();
    if (map_.form.second_comb == 0) return "";
    std::string text =
        "    const @real@ turned = @name@_fma(joint_deg, (@real@)0.002777777777777778, @name@_limits[1]);\n"
        "    @real@ c, s;\n";
    for (std::size_t i = 0; i < orders; ++i) {
        text += fmt::format(
            "    @name@_on_circle((@real@){0} * turned, &c, &s);\n"
            "    z[{1}] += @name@_fma(c, z[{3}], {5}s * z[{4}]);\n"
            "    z[{2}] += @name@_fma(c, z[{4}], {6}s * z[{3}]);\n",
            map_.orders[i].value(), 2 * i, 2 * i + 1, 2 * (orders + i), 2 * (orders + i) + 1,
            map_.form.second_comb > 0 ? "" : "-", map_.form.second_comb > 0 ? "-" : "");
    }
    return text;
}

std::string MapCode::definitions() const {
    const MapForm& form = map_.form;
    const MapTables tables(map_);
    std::string text = style_.array("speeds", tables.speeds) + style_.array("slopes", tables.slopes) +
                       style_.array("offsets", tables.offsets) + style_.array("limits", tables.limits) +
                       style_.array("amplitudes", tables.amplitudes);
    if (is_constant()) return text;
    std::string code = fmt::format(
        "\n/* Of each order the amplitudes of cosine and sine, Nm. */\n"
        "static inline void @name@_at({}@real@* z) {{\n",
        arguments(true));
    // C99 lets declarations follow statements.
    if (form.speeds_deg_s.size() > 1)
        code += filled(std::string(along_code), {{"@speeds@", std::to_string(form.speeds_deg_s.size())}});
    if (form.directions == 1) {
        code += side(0, "    ", "z[{0}] = {1};");
    } else {
        // Each side in a statement of its own: with both in one expression a compiler looks both up.
        code += "    if (speed_deg_s >= @name@_limits[0]) {\n" + side(0, "        ", "z[{0}] = {1};") +
                "    } else if (speed_deg_s <= -@name@_limits[0]) {\n" +
                side(1, "        ", "z[{0}] = {1};") +
                "    } else { /* the directions run into each other */\n"
                "        const @real@ share = (@real@)0.5 - (@real@)0.5 * speed_deg_s / @name@_limits[0];\n" +
                "        {\n" + side(0, "            ", "z[{0}] = {1};") + "        }\n" +
                side(1, "        ", "z[{0}] = @name@_fma(share, {1} - z[{0}], z[{0}]);") + "    }\n";
    }
    return text + code + combined() + "}\n";
}

std::string by_shaft(std::string code, const std::vector<double>& orders, GearRatio ratio) {
    const bool joint = ratio == no_ratio;
    const std::string_view fraction = repeats_each_turn(orders)
                                          ? "the fraction of the turn is enough"
                                          : "whole turns count, for not every order is whole";
    return filled(std::move(code), {{"@shaft@", joint ? "joint" : "motor"},
                                    {"@fraction@", std::string(fraction)},
                                    {"motor_turns", joint ? "joint_turns" : "motor_turns"}});
}

std::string order_angles_code(const std::vector<double>& orders, std::string_view turns) {
    std::string text = "    @real@ ";
    for (std::size_t i = 0; i < orders.size(); ++i)
        text += fmt::format("{}c{}, s{}", i > 0 ? ", " : "", i, i);
    text += ";\n";
    for (std::size_t i = 0; i < orders.size(); ++i) {
        const std::size_t half = half_of(orders, i);
        if (half < i) {
            text += fmt::format(
                "    s{0} = s{1} + s{1};\n    c{0} = @name@_fma(-s{0}, s{1}, 1);\n    s{0} *= c{1};\n", i,
                half);
        } else {
            text += fmt::format("    @name@_on_circle({}({}), &c{}, &s{});\n",
                                orders[i] == 1.0 ? "" : fmt::format("@name@_orders[{}] * ", i), turns, i, i);
        }
    }
    return text;
}

}  // namespace ripplenotch
