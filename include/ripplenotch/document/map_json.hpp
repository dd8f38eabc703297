// SPDX-License-Identifier: MIT
#pragma once
// map.json: a ripple map as filter, export and report read it.

#include <string>
#include <string_view>

#include "ripplenotch/document/provenance.hpp"
#include "ripplenotch/filter/map_fit.hpp"

namespace ripplenotch {

/// The whole text of map.json, schema ripplenotch/map/1; same map, same bytes.
[[nodiscard]] std::string map_text(const MapFit& fit, const Provenance& provenance);

/// Reads map.json back. Throws DataError that names `source`, the field, what it holds and what was expected.
[[nodiscard]] MapFit map_from_json(std::string_view text, const std::string& source);

/// map_from_json of a file, or of standard input when the path is "-".
[[nodiscard]] MapFit load_map(const std::string& path);

/// Whether the file of this name is a document of this kind ("map", "model"), by its first lines. False for
/// what is no regular file: it could not be read again.
[[nodiscard]] bool is_document(const std::string& path, std::string_view kind);

}  // namespace ripplenotch
