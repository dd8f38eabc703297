// SPDX-License-Identifier: MIT
#pragma once
// Ripple beside a leftover seldom keeps its size: the joint's own elasticity swells and turns it with the
// speed. What is added to a ripple so must be worth its own price.

#include <vector>

#include "diagnose/beside/naming/evidence.hpp"
#include "diagnose/beside/naming/exchanges.hpp"

namespace ripplenotch {

/// Of trials in their order the first of each last name, of a ripple that which rings and that which does
/// not.
void keep_first_of_each(const Sums& sums, std::vector<Named>& trials);
/// True as well of a name that does not ring; false of what rings at a bound of its frequency or damping.
[[nodiscard]] bool is_worth_ringing(const Sums& sums, const Names& names, std::size_t place,
                                    std::size_t effects);
/// What ringing is worth beside the same ripple without it; the name at `place` rings.
[[nodiscard]] OutsideGain gain_of_ringing(const Sums& sums, const Names& names, std::size_t place);
/// `now`, whose name at `place` rings, refined from each other frequency at which its search begins; of these
/// the one that leaves least. The valley nearest to the best beginning is not always the deepest.
[[nodiscard]] Named refined_from_others(Sums& sums, const Named& now, std::size_t place);
/// Ripple that is named gets what rings in it, where that is worth its price.
[[nodiscard]] Named with_ringing(Sums& sums, Named now, std::size_t effects);
/// Ripple keeps what rings in it as long as that is worth its price beside the other names.
[[nodiscard]] Named without_idle_ringing(Sums& sums, Named now, std::size_t effects);

}  // namespace ripplenotch
