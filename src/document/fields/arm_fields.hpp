// SPDX-License-Identifier: MIT
#pragma once
// The member `arm` of a model.json.

#include "document/archive/json_reader.hpp"
#include "document/archive/json_writer.hpp"
#include "ripplenotch/arm/arm_fit.hpp"

namespace ripplenotch {

void describe(JsonWriter& json, const StatedArm& arm);

/// Throws DataError as well for a joint that the chain has not, and for links of another number of joints.
void describe(JsonReader& reader, StatedArm& arm);

}  // namespace ripplenotch
