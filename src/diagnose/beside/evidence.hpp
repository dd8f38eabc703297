// SPDX-License-Identifier: MIT
#pragma once
// What a name has to be worth.

#include "diagnose/beside/outside_gain.hpp"
#include "diagnose/beside/sums.hpp"

namespace ripplenotch {

/// Gain that chance might bring with a shape: its free values, its places, and all effects tried.
[[nodiscard]] double price_of(const Sums& sums, std::size_t shape, std::size_t effects);

}  // namespace ripplenotch
