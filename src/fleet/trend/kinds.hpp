// SPDX-License-Identifier: MIT
#pragma once
// Internal: a joint against the others of its kind, which are those of its name on other robots.

#include <span>
#include <vector>

#include "fleet/trend/change_test.hpp"
#include "ripplenotch/fleet/trend.hpp"

namespace ripplenotch {

// Internal: a joint over time as a figure shows it, without what its conditions explain.

/// Fills in the months of the joint, and the course of the surest descriptor of each of its changes.
void tell_courses(const JointHistory& history, std::span<const FoundChange> changes, JointTrend& joint);

/// Fills in which joints are odd, how many of a kind share a change, and puts those that differ from their
/// kind first.
void compare_kinds(std::vector<JointTrend>& joints);

}  // namespace ripplenotch
