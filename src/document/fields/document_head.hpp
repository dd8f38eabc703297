// SPDX-License-Identifier: MIT
#pragma once
// What every document begins with, and the way in of those that are read.

#include <string>
#include <string_view>

#include "document/json/json.hpp"
#include "ripplenotch/document/provenance.hpp"

namespace ripplenotch {

/// {"schema": "ripplenotch/<kind>/1", "tool", "version", "command", "inputs"}: the opening of every document.
[[nodiscard]] Json document_head(std::string_view kind, const Provenance& provenance);

/// Parses a document and checks its schema. Throws DataError with file, line and column of a syntax error,
/// and the schema expected and found.
[[nodiscard]] Json parse_document(std::string_view text, const std::string& source, std::string_view kind);

/// A document of any kind that a command writes: "table", "metrics".
struct AnyDocument {
    std::string kind;
    Json json = Json::object();
};
/// The same for a document of any of these kinds, with a head whose fields are of their types.
[[nodiscard]] AnyDocument parse_any_document(std::string_view text, const std::string& source);

}  // namespace ripplenotch
