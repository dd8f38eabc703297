// SPDX-License-Identifier: MIT
#pragma once
#include "ripplenotch/export/target.hpp"

namespace ripplenotch::map_target_list {

// The entries of the registry of map targets, declared from its one list.

#define MAP_TARGET(name) extern const MapTarget name;
#include "export/map_targets/map_targets.def"
#undef MAP_TARGET

}  // namespace ripplenotch::map_target_list
