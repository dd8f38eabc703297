// SPDX-License-Identifier: MIT
#pragma once
// Keys of the methods that subtract a map.

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

#include "filter/ripple/ripple_keys.hpp"
#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/design/ripple_map.hpp"

namespace ripplenotch {

namespace map_keys_detail {

inline constexpr std::array<std::string_view, 2> temperature_of = {"stated", "rows"};
inline constexpr std::array<std::string_view, 2> beyond = {"refuse", "hold"};

constexpr Key list_of(std::string_view name, Dimension dimension, std::string_view help,
                      double at_least = -1e300) {
    return {.name = name, .kind = KeyKind::list, .dimension = dimension, .at_least = at_least, .help = help};
}
constexpr Key whole(std::string_view name, std::string_view usual, double least, double most,
                    std::string_view help) {
    return {
        .name = name, .default_text = usual, .at_least = least, .at_most = most, .whole = true, .help = help};
}

}  // namespace map_keys_detail

/// `map` is never seen by a method: whoever loads files replaces it by the keys that it stands for.
inline constexpr std::array ripple_map_keys = {
    Key{.name = "map",
        .kind = KeyKind::text,
        .help = "map.json of the command map: the keys below, unless given"},
    map_keys_detail::list_of("cosines", Dimension::torque,
                             "of ripple = cosine cos(n motor angle) + sine sin(n motor angle): all values of "
                             "the first order, then of the next; or map=map.json"),
    map_keys_detail::list_of("sines", Dimension::torque, "as cosines"),
    map_keys_detail::list_of("speeds", Dimension::speed,
                             "joint speeds at which an order has a value; one for all when left out", 0.0),
    map_keys_detail::whole("directions", "1", 1.0, 2.0, "2: values forward, then values backward"),
    map_keys_detail::whole(
        "turn-harmonics", "0", 0.0, 8.0,
        "after those of the speeds, a cosine and a sine of 1, 2, ... times the joint's own angle"),
    map_keys_detail::whole("by-load", "0", 0.0, 1.0, "1: last, a value in proportion to the torque, per Nm"),
    map_keys_detail::whole("by-temperature", "0", 0.0, 1.0,
                           "1: behind it, a value per degC beyond the middle of the temperatures"),
    Key{.name = "slowest",
        .dimension = Dimension::speed,
        .default_text = "0deg/s",
        .at_least = 0.0,
        .help = "below it the two directions run into each other"},
    map_keys_detail::list_of("positions", Dimension::angle,
                             "least and greatest joint position that was seen"),
    map_keys_detail::list_of("loads", Dimension::torque, "least and greatest torque that was seen"),
    Key{.name = "temperatures",
        .kind = KeyKind::list,
        .at_least = -274.0,
        .at_most = 1000.0,
        .help = "least and greatest temperature that was seen, degC"},
    Key{.name = "temperature",
        .at_least = -274.0,
        .at_most = 1000.0,
        .help = "of the joint, degC; for a map that depends on it, by default the mean of the log's column"},
    Key{.name = "temperature-of",
        .kind = KeyKind::choice,
        .default_text = "stated",
        .choices = map_keys_detail::temperature_of,
        .help = "rows: the temperature is that of each row, and the stated one where a row has none"},
    map_keys_detail::list_of("spread", Dimension::torque, "by how much each order strays from the map, rms",
                             0.0),
    Key{.name = "fastest",
        .dimension = Dimension::speed,
        .above = 0.0,
        .help = "speed up to which the map was made"},
    Key{.name = "beyond",
        .kind = KeyKind::choice,
        .default_text = "refuse",
        .choices = map_keys_detail::beyond,
        .help = "a joint half as fast again: refuse, as another joint; hold: the map's edge"},
    map_keys_detail::whole(
        "second-comb", "0", -1.0, 1.0,
        "1 or -1: after those of the speeds, as many of lines at n (gear ratio + 1) or n (gear ratio - 1)")};

/// One list of several.
template <std::size_t... Sizes>
constexpr auto joined_keys(const std::array<Key, Sizes>&... lists) {
    std::array<Key, (Sizes + ...)> all{};
    std::size_t at = 0;
    const auto append = [&](const auto& list) {
        for (const Key& key : list) all[at++] = key;
    };
    (append(lists), ...);
    return all;
}

/// The map's keys for a method that is nothing without its values.
constexpr auto required_map_keys() {
    auto keys = ripple_map_keys;
    for (Key& key : keys) key.required = key.name == "cosines" || key.name == "sines";
    return keys;
}

/// A map, counted from position 0, and the temperature that it is taken at.
struct StatedMap {
    RippleMap map;
    double degc = 0.0;  ///< clamped to the range of the map; means nothing where it does not depend on it
    bool follows_rows = false;  ///< the temperature of each row counts

    /// The map at its temperature: one that does not depend on it.
    [[nodiscard]] RippleMap at_temperature() const;
};

/// The map that the keys hold; empty without cosines. Throws UsageError when there are more or fewer values
/// than orders and form ask for, or no temperature for a map that depends on it.
[[nodiscard]] std::optional<StatedMap> map_of(std::string_view method, const Settings& settings,
                                              const RippleOrders& ripple);

}  // namespace ripplenotch
