// SPDX-License-Identifier: MIT
#pragma once
// Internal to the analysis room: a start for what the velocity of logs without position is off by.

#include <span>
#include <vector>

#include "ripplenotch/analysis/steady_lines.hpp"

namespace ripplenotch {

/// Of the fastest speed, a standard deviation, as in changing motion.
inline constexpr double likely_offset_share = 0.01;  // by hand

/// True when these speeds, by their sign, too, are three or more: two agree on an order at some offset,
/// whatever they are.
[[nodiscard]] bool speeds_tell_offset(std::vector<double> signed_deg_s);

/// The offset, from -3 to 3 % of the fastest speed, at which the clearest sightings of different speeds agree
/// best on their orders; smaller ones are likelier beforehand (normal, 1 %). A start, as coarse as a
/// twentieth of a percent. 0 where their speeds do not tell it. `sightings` are of logs without position.
[[nodiscard]] DegPerSec likely_offset(std::span<const Sighting> sightings);

}  // namespace ripplenotch
