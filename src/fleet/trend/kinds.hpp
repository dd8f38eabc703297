// SPDX-License-Identifier: MIT
#pragma once
// Internal: a joint against the others of its kind, which are those of its name on other robots.

#include <vector>

#include "ripplenotch/fleet/trend.hpp"

namespace ripplenotch {

/// Fills in which joints are odd, how many of a kind share a change, and puts those that differ from their
/// kind first.
void compare_kinds(std::vector<JointTrend>& joints);

}  // namespace ripplenotch
