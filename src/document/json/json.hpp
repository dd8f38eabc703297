// SPDX-License-Identifier: MIT
#pragma once
// The only door to the JSON library; included by files in src/document alone.

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

namespace ripplenotch {

using Json = nlohmann::ordered_json;

/// Text with two spaces of indentation, numbers shortest round trip, a line feed at the end: for what another
/// program computes with (tables, models, settings).
[[nodiscard]] std::string to_text(const Json& json);

/// The same for what was fitted or measured: every number but a time (a name that ends in _s) has
/// fitted_digits.
[[nodiscard]] std::string to_fitted_text(Json json);

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

template <class Value>
[[nodiscard]] Json or_null(const std::optional<Value>& value) {
    return value ? Json(*value) : Json(nullptr);
}

/// Six significant digits of what was fitted or measured, where more would be rounding noise; null for what
/// is not finite.
[[nodiscard]] Json six_digits(double value);
[[nodiscard]] inline Json six_digits(const std::optional<double>& value) {
    return value ? six_digits(*value) : Json(nullptr);
}

}  // namespace ripplenotch
