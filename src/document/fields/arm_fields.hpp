// SPDX-License-Identifier: MIT
#pragma once
// The member `arm` of a model.json.

#include "document/fields/fields.hpp"
#include "ripplenotch/arm/arm_fit.hpp"

namespace ripplenotch {

[[nodiscard]] Json stated_arm_json(const StatedArm& arm);

/// Throws DataError: a field missing, mistyped or unknown, a joint that the chain has not, links for another
/// number of joints.
[[nodiscard]] StatedArm stated_arm_of(Fields& fields, const std::string& source);

}  // namespace ripplenotch
