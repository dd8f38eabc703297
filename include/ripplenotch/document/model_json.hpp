// SPDX-License-Identifier: MIT
#pragma once
// model.json: a model of a joint as people and commands write it; docs/formats/model.md describes it.

#include <string>
#include <string_view>

#include "ripplenotch/document/provenance.hpp"
#include "ripplenotch/model/model.hpp"

namespace ripplenotch {

/// Text of model.json. Values that the model does not state are left out.
[[nodiscard]] std::string write_model(const Model& model, const Provenance& provenance);

/// Reads model.json; `source` is its name in messages. A parameter left out is to be fitted. Throws
/// DataError: not JSON, another schema, an unknown effect, parameter or field, a value out of its bounds, no
/// gear ratio.
[[nodiscard]] Model read_model(std::string_view text, const std::string& source);

}  // namespace ripplenotch
