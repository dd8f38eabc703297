// SPDX-License-Identifier: MIT
#pragma once
// What several searches of this room decide by.

#include <cstddef>

namespace ripplenotch {

/// Of likelihood (odds of 150 to 1), by which one account of a line has to be better than another.
inline constexpr double decisive_nats = 5.0;  // by hand
/// Of a gain: the noise below a line is not known better.
inline constexpr double floor_doubt = 0.15;  // by hand
/// Maxima are looked for among correlated bins: about this many independent tries per cell. With it, white
/// noise raises a false alarm somewhat less often than allowed.
inline constexpr double tries_per_cell = 1.6;
/// Of the polynomial that takes the slow course off a window: a cubic, since a quadratic leaks
/// into order 2 where a joint turns round.
inline constexpr std::ptrdiff_t window_trend_terms = 4;

}  // namespace ripplenotch
