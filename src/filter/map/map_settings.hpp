// SPDX-License-Identifier: MIT
#pragma once
// Keys of the methods that subtract a map.

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

#include "filter/ripple_keys.hpp"
#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/design/ripple_map.hpp"

namespace ripplenotch {

/// `map` never reaches a method: the code that loads files replaces it by the keys that it abbreviates.
inline constexpr std::array ripple_map_keys = [] {
    const auto list = [](std::string_view name, Dimension dimension, std::string_view help,
                         double least = Key{}.at_least) {
        return Key{
            .name = name, .kind = KeyKind::list, .dimension = dimension, .at_least = least, .help = help};
    };
    const auto whole = [](std::string_view name, double least, double most, std::string_view help) {
        const std::string_view usual = least > 0.0 ? "1" : "0";
        return Key{.name = name,
                   .default_text = usual,
                   .at_least = least,
                   .at_most = most,
                   .whole = true,
                   .help = help};
    };
    return std::array{
        Key{.name = "map",
            .kind = KeyKind::text,
            .help = "map.json of the command map: the keys below, unless given"},
        list("cosines", Dimension::torque,
             "of ripple = cosine cos(n motor angle) + sine sin(n motor angle): all values of the first "
             "order, then of the next; or map=map.json"),
        list("sines", Dimension::torque, "as cosines"),
        list("speeds", Dimension::speed,
             "joint speeds at which an order has a value; one for all when left out", 0.0),
        whole("directions", 1.0, 2.0, "2: values forward, then values backward"),
        Key{.name = "slowest",
            .dimension = Dimension::speed,
            .default_text = "0deg/s",
            .at_least = 0.0,
            .help = "below it the two directions run into each other"},
        list("positions", Dimension::angle, "least and greatest joint position that was seen"),
        list("spread", Dimension::torque, "by how much each order strays from the map, rms", 0.0),
        Key{.name = "fastest",
            .dimension = Dimension::speed,
            .above = 0.0,
            .help = "speed up to which the map was made"},
        Key{.name = "beyond",
            .default_text = "refuse",
            .choices = "refuse hold",
            .help = "a joint half as fast again: refuse, as another joint; hold: the map's edge"},
        whole("second-comb", -1.0, 1.0,
              "1 or -1: after those of the speeds, as many of lines at n (gear ratio + 1) or n (gear ratio - "
              "1)")};
}();

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

/// The orders as a method runs on them: by the lowest, but by the motor with a second comb, which is a
/// multiple of its turns.
[[nodiscard]] RippleOrders counted_orders(std::string_view method, const Settings& settings);

/// The map that the keys hold, counted from position 0; empty without cosines. Throws UsageError when there
/// are more or fewer values than orders and form require.
[[nodiscard]] std::optional<RippleMap> map_of(std::string_view method, const Settings& settings,
                                              const RippleOrders& ripple);

/// Multiplications in a sample of the map that the keys hold; 0 without one.
[[nodiscard]] double map_multiplications(const Settings& settings);

// Keys of the method oscillator.

inline constexpr std::array oscillator_own_keys = {
    gear_ratio_key,
    orders_key,
    joint_key,
    Key{.name = "bandwidth",
        .dimension = Dimension::frequency,
        .default_text = "15Hz",
        .above = 0.0,
        .help = "of the torque: what is faster and no ripple counts as noise"},
    Key{.name = "memory",
        .above = 0.0,
        .at_most = 1e6,
        .help =
            "periods of the lowest order (turns of the motor, of order 1) over which the ripple's amplitude "
            "may change; 0.5, and with a map 0.15"},
    Key{.name = "amplitudes",
        .kind = KeyKind::list,
        .dimension = Dimension::torque,
        .at_least = 0.0,
        .help = "warm start: zero to peak, one per order, e.g. 0.8Nm:0.5Nm"},
    Key{.name = "phases",
        .kind = KeyKind::list,
        .dimension = Dimension::angle,
        .help =
            "warm start: of cos(n motor angle + phase), one per order; the motor angle is gear ratio times "
            "position"},
    Key{.name = "trust",
        .default_text = "0.1",
        .above = 0.0,
        .at_most = 10.0,
        .help = "warm start: how far amplitudes and phases may be off, as a share of the amplitude"},
    Key{.name = "noise",
        .dimension = Dimension::torque,
        .default_text = "0.05Nm",
        .above = 0.0,
        .help = "rms noise of the sensor"},
    Key{.name = "largest",
        .dimension = Dimension::torque,
        .default_text = "1Nm",
        .above = 0.0,
        .help = "cold start: amplitude that an order may well have"},
    Key{.name = "gain",
        .default_text = "exact",
        .choices = "exact scheduled",
        .help =
            "exact: worked out at every sample; scheduled: the settled one of the present speed, cheaper, "
            "slower to start"},
    Key{.name = "rest",
        .dimension = Dimension::torque,
        .help =
            "torque that the joint is known to bear where a log begins at standstill, 0Nm for an unloaded "
            "arm: the rest is ripple"},
    angle_key,
    Key{.name = "start",
        .dimension = Dimension::angle,
        .help = "position at the first row of a log without one, so that phases mean something"},
    Key{.name = "offset",
        .dimension = Dimension::speed,
        .default_text = "2deg/s",
        .above = 0.0,
        .help = "angle from velocity: largest offset of the velocity that the ripple may correct"},
    Key{.name = "jump",
        .default_text = "0",
        .at_least = 0.0,
        .at_most = 1e6,
        .help = "a sample that deviates by more than this many of its standard deviations is a jump of the "
                "torque, not ripple; 0: none is"},
    Key{.name = "slip",
        .default_text = "0.03",
        .at_least = 0.0,
        .at_most = 0.2,
        .help = "angle from position: largest share by which the ripple may correct the gear ratio"},
    Key{.name = "output",
        .default_text = "torque",
        .choices = "torque minus-ripple",
        .help = "torque: the estimate, smoothed; minus-ripple: the log's own torque less the ripple"},
};
inline constexpr std::array oscillator_map_keys = {
    Key{.name = "zero",
        .default_text = "known",
        .choices = "known unknown",
        .help = "with a map: unknown finds the motor's angle anew within one turn, as after a new encoder"},
    Key{.name = "return",
        .default_text = "5",
        .above = 0.0,
        .at_most = 1e6,
        .help =
            "with a map: periods of the lowest order over which what was followed is forgotten towards the "
            "map"},
};

inline constexpr auto oscillator_keys =
    joined_keys(oscillator_own_keys, ripple_map_keys, oscillator_map_keys);

}  // namespace ripplenotch
