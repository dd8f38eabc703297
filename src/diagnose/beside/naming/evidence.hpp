// SPDX-License-Identifier: MIT
#pragma once
// What a name has to be worth.

#include "diagnose/beside/weighing/outside_gain.hpp"
#include "diagnose/beside/weighing/sums.hpp"

namespace ripplenotch {

/// Gain that chance might bring with a shape: its free values, its places, and all effects tried.
[[nodiscard]] double price_of(const Sums& sums, std::size_t shape, std::size_t effects);
/// The same of what rings in a ripple that is there already.
[[nodiscard]] double price_of_ringing(const Sums& sums, std::size_t shape, std::size_t effects);

/// What the last of the names is worth beside those before it.
[[nodiscard]] OutsideGain gain_between(const Sums& sums, const Names& without, const Names& with);

}  // namespace ripplenotch
