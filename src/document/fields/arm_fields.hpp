// SPDX-License-Identifier: MIT
#pragma once
// The members `arm` and `ripple_map` of a model.json.

#include "document/archive/json_reader.hpp"
#include "document/archive/json_writer.hpp"
#include "ripplenotch/arm/arm_fit.hpp"
#include "ripplenotch/filter/map_fit.hpp"

namespace ripplenotch {

void describe(JsonWriter& json, const StatedArm& arm);
void describe(JsonWriter& json, const MapFit& fit);
void describe(JsonReader& reader, MapFit& fit);

/// Throws DataError as well for a joint that the chain has not, and for links of another number of joints.
void describe(JsonReader& reader, StatedArm& arm);

}  // namespace ripplenotch
