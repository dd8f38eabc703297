// SPDX-License-Identifier: MIT
#pragma once
// Keys of the methods that subtract a map.

#include <array>
#include <optional>
#include <string_view>

#include "filter/ripple/ripple_keys.hpp"
#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/design/ripple_map.hpp"

namespace ripplenotch {

/// Never seen by a method: whoever loads files replaces it by the keys that it stands for.
inline constexpr Key map_key{.name = "map",
                             .kind = KeyKind::text,
                             .help = "map.json of the command map: the keys below, unless given"};
inline constexpr Key cosines_key{
    .name = "cosines",
    .kind = KeyKind::list,
    .dimension = Dimension::torque,
    .help =
        "of ripple = cosine cos(n motor angle) + sine sin(n motor angle): all values of the first order, "
        "then of the next; or map=map.json"};
inline constexpr Key sines_key{
    .name = "sines", .kind = KeyKind::list, .dimension = Dimension::torque, .help = "as cosines"};
inline constexpr Key speeds_key{
    .name = "speeds",
    .kind = KeyKind::list,
    .dimension = Dimension::speed,
    .at_least = 0.0,
    .help = "joint speeds at which an order has a value; one for all when left out"};
inline constexpr Key directions_key{.name = "directions",
                                    .default_text = "1",
                                    .at_least = 1.0,
                                    .at_most = 2.0,
                                    .whole = true,
                                    .help = "2: values forward, then values backward"};
inline constexpr Key turn_harmonics_key{
    .name = "turn-harmonics",
    .default_text = "0",
    .at_least = 0.0,
    .at_most = 8.0,
    .whole = true,
    .help = "after those of the speeds, a cosine and a sine of 1, 2, ... times the joint's own angle"};
inline constexpr Key by_load_key{.name = "by-load",
                                 .default_text = "0",
                                 .at_least = 0.0,
                                 .at_most = 1.0,
                                 .whole = true,
                                 .help = "1: last, a value in proportion to the torque, per Nm"};
inline constexpr Key by_temperature_key{
    .name = "by-temperature",
    .default_text = "0",
    .at_least = 0.0,
    .at_most = 1.0,
    .whole = true,
    .help = "1: behind it, a value per degC beyond the middle of the temperatures"};
inline constexpr Key second_comb_key{
    .name = "second-comb",
    .default_text = "0",
    .at_least = -1.0,
    .at_most = 1.0,
    .whole = true,
    .help =
        "1 or -1: after those of the speeds, as many of lines at n (gear ratio + 1) or n (gear ratio - 1)"};
inline constexpr Key slowest_key{.name = "slowest",
                                 .dimension = Dimension::speed,
                                 .default_text = "0deg/s",
                                 .at_least = 0.0,
                                 .help = "below it the two directions run into each other"};
inline constexpr Key positions_key{.name = "positions",
                                   .kind = KeyKind::list,
                                   .dimension = Dimension::angle,
                                   .help = "least and greatest joint position that was seen"};
inline constexpr Key loads_key{.name = "loads",
                               .kind = KeyKind::list,
                               .dimension = Dimension::torque,
                               .help = "least and greatest torque that was seen"};
inline constexpr Key temperatures_key{.name = "temperatures",
                                      .kind = KeyKind::list,
                                      .at_least = -274.0,
                                      .at_most = 1000.0,
                                      .help = "least and greatest temperature that was seen, degC"};
inline constexpr Key temperature_key{
    .name = "temperature",
    .at_least = -274.0,
    .at_most = 1000.0,
    .help = "of the joint, degC; for a map that depends on it, by default the mean of the log's column"};
inline constexpr std::array<std::string_view, 2> temperature_of_choices = {"stated", "rows"};
inline constexpr Key temperature_of_key{
    .name = "temperature-of",
    .kind = KeyKind::choice,
    .default_text = "stated",
    .choices = temperature_of_choices,
    .help = "rows: the temperature is that of each row, and the stated one where a row has none"};
inline constexpr Key spread_key{.name = "spread",
                                .kind = KeyKind::list,
                                .dimension = Dimension::torque,
                                .at_least = 0.0,
                                .help = "by how much each order strays from the map, rms"};

/// The map that the keys hold, counted from position 0; empty without cosines. Throws UsageError when there
/// are more or fewer values than orders and form ask for.
/// A map that depends on the temperature is the one at the temperature stated.
[[nodiscard]] std::optional<RippleMap> map_of(std::string_view method, const Settings& settings,
                                              const RippleOrders& ripple);
/// The same at any temperature; empty where none of a row counts.
[[nodiscard]] std::optional<RippleMap> warming_map_of(std::string_view method, const Settings& settings,
                                                      const RippleOrders& ripple);

}  // namespace ripplenotch
