// SPDX-License-Identifier: MIT
#pragma once
// The one door through which JSON comes in: nothing behind it meets a document that is deep, huge or
// ambiguous.

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>

namespace ripplenotch {

// The only door to the JSON library; included by files in src/document alone.

using Json = nlohmann::ordered_json;

/// Text with two spaces of indentation, numbers shortest round trip, a line feed at the end: for what another
/// program computes with (tables, models, settings).
[[nodiscard]] std::string to_text(const Json& json);

/// The same for what was fitted or measured: every number but a time (a name that ends in _s) has
/// fitted_digits.
[[nodiscard]] std::string to_fitted_text(Json json);

/// Null for what is not finite: JSON has no nan.
[[nodiscard]] inline Json finite_or_null(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}

/// Six significant digits of what was fitted or measured, where more would be rounding noise; null for what
/// is not finite.
[[nodiscard]] Json six_digits(double value);

// What a document may be at most: far above what the commands write, and so little that reading it takes less
// than two seconds. docs/reliability.md has the same table.

constexpr std::size_t max_json_bytes = 32U << 20U;  ///< of the text

constexpr std::size_t max_json_depth = 24;  ///< of lists and objects within each other

constexpr std::size_t max_json_values = 1000000;  ///< texts, numbers, lists and objects together

constexpr std::size_t max_json_members = 1000;  ///< of one object

constexpr std::size_t max_entries = 10000;  ///< objects in one list of a document that is read as a result

constexpr std::size_t max_effects = 256;  ///< of a model

constexpr std::size_t most_lines = 100;  ///< of a joint

constexpr std::size_t max_panels = 16;  ///< of a figure

constexpr std::size_t max_curves = 200;  ///< of a panel, and ribbons, and lines

constexpr std::size_t max_words = 4000;  ///< bytes of a title, sentence or name in a figure

constexpr std::size_t max_shades = 20000;  ///< of a panel: two a band of a table

/// The document in `text`, within these limits and with every name once in its object. Throws
/// DataError with source, line and column, what was read, and that `wanted` was expected. Linear in the
/// length of the text.
[[nodiscard]] Json read_json(std::string_view text, const std::string& source, std::string_view wanted);

}  // namespace ripplenotch
