// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>

namespace ripplenotch {

// Internal to the core room: the shortest text that reads back as the same double, for the numbers that logs
// are made of.

/// At `into`, where there are 32 bytes, and returns its end; null, with nothing of use written, for zero,
/// powers of two, magnitudes below 2^-13 or from 2^26 on, and what is no finite number. The text is that of
/// the formatting library's "{}": of all decimals between the halfway points to the neighbouring doubles one
/// with the fewest digits, and of these the nearest.
char* put_usual_shortest(char* into, double value);

/// All that a double holds exactly.
inline constexpr std::array<double, 23> powers_of_ten = [] {
    std::array<double, 23> powers{1.0};
    for (std::size_t n = 1; n < powers.size(); ++n) powers[n] = 10.0 * powers[n - 1];
    return powers;
}();

}  // namespace ripplenotch
