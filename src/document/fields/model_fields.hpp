// SPDX-License-Identifier: MIT
#pragma once
// The fields of a model, for documents that hold one.

#include "document/fields/fields.hpp"
#include "ripplenotch/model/model.hpp"

namespace ripplenotch {

/// Sets "gear_ratio" and "effects" of an object.
void put_model(Json& json, const Model& model);

/// Reads "gear_ratio" and "effects". Throws DataError as read_model() does.
[[nodiscard]] Model model_of(Fields& fields, bool beside_simulation);

/// The effect that "effect" names. Throws DataError for a name that the catalogue does not have.
[[nodiscard]] const Effect& effect_of(Fields& fields);

}  // namespace ripplenotch
