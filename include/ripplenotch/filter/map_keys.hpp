// SPDX-License-Identifier: MIT
#pragma once
// A ripple map as the keys of a method: what map=map.json stands for.

#include <string>
#include <utility>
#include <vector>

#include "ripplenotch/design/ripple_map.hpp"

namespace ripplenotch {

/// gear-ratio, orders, cosines, sines and what else the form needs, in the order of the page; angles count
/// from position 0 then. The map has an order.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> map_as_keys(const RippleMap& map);

}  // namespace ripplenotch
