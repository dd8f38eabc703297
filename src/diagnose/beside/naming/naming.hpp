// SPDX-License-Identifier: MIT
#pragma once
// Which effects are there beside a leftover: forward on what is left out of fold, each step mended by
// exchanges; then backward.

#include "diagnose/beside/naming/evidence.hpp"
#include "diagnose/beside/naming/exchanges.hpp"

namespace ripplenotch {

/// `names` with what should be added and without what no longer passes. `effects`: how many the catalogue
/// has, for the price.
[[nodiscard]] Named search_beside(Sums& sums, Named names, const Barred& barred, std::size_t effects);

}  // namespace ripplenotch
