// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>

namespace ripplenotch {

/// All that a double holds exactly.
inline constexpr std::array<double, 23> powers_of_ten = [] {
    std::array<double, 23> powers{1.0};
    for (std::size_t n = 1; n < powers.size(); ++n) powers[n] = 10.0 * powers[n - 1];
    return powers;
}();

}  // namespace ripplenotch
