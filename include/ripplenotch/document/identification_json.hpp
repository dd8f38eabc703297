// SPDX-License-Identifier: MIT
#pragma once
// joint.json: what identify found, the input of design.

#include <span>
#include <string>
#include <string_view>

#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/document/provenance.hpp"

namespace ripplenotch {

/// The whole text of joint.json; same identification, same bytes.
[[nodiscard]] std::string identification_text(const Identification& identification,
                                              const Provenance& provenance);

/// Several joints of one file in one object, schema ripplenotch/joints/1: {"joints": [...]}, each entry with
/// the fields of joint.json.
[[nodiscard]] std::string identifications_text(std::span<const Identification> identifications,
                                               const Provenance& provenance);

/// Reads joint.json back. Throws DataError that names `source`, the field, what it holds and what was
/// expected.
[[nodiscard]] Identification identification_from_json(std::string_view text, const std::string& source);

/// identification_from_json of a file, or of standard input when the path is "-".
[[nodiscard]] Identification load_identification(const std::string& path);

}  // namespace ripplenotch
