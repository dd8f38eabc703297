// SPDX-License-Identifier: MIT
#pragma once
// Internal: a joint over time as a figure shows it, without what its conditions explain.

#include <span>

#include "fleet/trend/change_test.hpp"

namespace ripplenotch {

/// Fills in the months of the joint, and the course of the surest descriptor of each of its changes.
void tell_courses(const JointHistory& history, std::span<const FoundChange> changes, JointTrend& joint);

}  // namespace ripplenotch
