// SPDX-License-Identifier: MIT
#pragma once
// The fields of a model, for documents that hold one.

#include "document/json.hpp"
#include "ripplenotch/model/model.hpp"

namespace ripplenotch {

/// Sets "gear_ratio" and "effects" of an object.
void put_model(Json& json, const Model& model);

}  // namespace ripplenotch
