// SPDX-License-Identifier: MIT
#pragma once
// The only door to the JSON library; included by files in src/document alone.

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "ripplenotch/document/provenance.hpp"

namespace ripplenotch {

using Json = nlohmann::ordered_json;

/// {"schema": "ripplenotch/<kind>/1", "tool", "version", "command", "inputs"}: the opening of every document.
[[nodiscard]] Json document_head(std::string_view kind, const Provenance& provenance);

/// Text with two spaces of indentation, numbers shortest round trip, a line feed at the end: for what another
/// program computes with (tables, models, settings).
[[nodiscard]] std::string to_text(const Json& json);

/// The same for what was fitted or measured: every number but a time (a name that ends in _s) has
/// fitted_digits.
[[nodiscard]] std::string to_fitted_text(Json json);

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

/// The list and the object that stand under a name, made where nothing does. The library's own way, to turn
/// null into either where it is written to, leaves a broken value behind where memory ends, and the program
/// with it.
[[nodiscard]] inline Json& list_in(Json& json, const char* name) {
    Json& there = json[name];
    if (there.is_null()) there = Json::array();
    return there;
}
[[nodiscard]] inline Json& object_in(Json& json, const char* name) {
    Json& there = json[name];
    if (there.is_null()) there = Json::object();
    return there;
}

/// Null for what is not finite: JSON has no nan.
[[nodiscard]] inline Json finite_or_null(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}

/// Six significant digits of what was fitted or measured, where more would be rounding noise; null for what
/// is not finite.
[[nodiscard]] Json six_digits(double value);
[[nodiscard]] inline Json six_digits(const std::optional<double>& value) {
    return value ? six_digits(*value) : Json(nullptr);
}

}  // namespace ripplenotch
