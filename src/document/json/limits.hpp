// SPDX-License-Identifier: MIT
#pragma once
// What a document may be at most: far above what the commands write, and so little that reading it takes less
// than two seconds. docs/security.md has the same table.

#include <cstddef>

namespace ripplenotch {

constexpr std::size_t most_json_bytes = 32U << 20U;  ///< of the text
constexpr std::size_t most_json_depth = 24;          ///< of lists and objects within each other
constexpr std::size_t most_json_values = 1000000;    ///< texts, numbers, lists and objects together
constexpr std::size_t most_json_members = 1000;      ///< of one object
constexpr double largest_json_number = 1e100;        ///< either side of 0
constexpr std::size_t most_entries = 10000;  ///< objects in one list of a document that is read as a result
constexpr std::size_t most_effects = 256;    ///< of a model
constexpr std::size_t most_lines = 100;      ///< of a joint
constexpr std::size_t most_panels = 16;      ///< of a figure
constexpr std::size_t most_curves = 200;     ///< of a panel, and ribbons, and lines
constexpr std::size_t most_words = 4000;     ///< bytes of a title, sentence or name in a figure
constexpr std::size_t most_shades = 20000;   ///< of a panel: two a band of a table

}  // namespace ripplenotch
