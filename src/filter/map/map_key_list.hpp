// SPDX-License-Identifier: MIT
#pragma once
// The keys of a map, for all methods that take one.

#include <array>
#include <cstddef>

#include "filter/map/map_reach.hpp"
#include "filter/map/map_settings.hpp"

namespace ripplenotch {

inline constexpr std::array ripple_map_keys = {
    map_key,         cosines_key,        sines_key,   speeds_key,    directions_key, turn_harmonics_key,
    by_load_key,     by_temperature_key, slowest_key, positions_key, loads_key,      temperatures_key,
    temperature_key, temperature_of_key, spread_key,  fastest_key,   beyond_key,     second_comb_key};

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
    for (Key& key : keys) key.required = key.name == cosines_key.name || key.name == sines_key.name;
    return keys;
}

}  // namespace ripplenotch
