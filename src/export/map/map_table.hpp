// SPDX-License-Identifier: MIT
#pragma once
// A flat map as a table over one motor turn.

#include <functional>
#include <vector>

#include "ripplenotch/design/ripple_map.hpp"

namespace ripplenotch {

/// Entry k is the ripple at k / entries of a turn. Orders that are no whole numbers do not close: they are
/// those of the turn that begins at 0.
[[nodiscard]] std::vector<double> turn_table(const RippleMap& flat, std::size_t entries);

/// What linear interpolation in such a table is wrong by at most: the second derivative's bound.
[[nodiscard]] double interpolation_bound_nm(const RippleMap& flat, std::size_t entries);

/// The ripple by linear interpolation, in float.
[[nodiscard]] std::function<double(const MapState&)> table_torque(std::vector<double> table,
                                                                  const RippleMap& map);

}  // namespace ripplenotch
