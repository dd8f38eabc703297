// SPDX-License-Identifier: MIT
#pragma once
// Internal to the log room: where the cells of a stretch of text begin and end.

#include <array>
#include <cstddef>
#include <cstdint>

namespace ripplenotch {

inline constexpr std::size_t stretch_bytes = 8192;

struct Separators {
    char delimiter, line_end;
};

/// The separators of a stretch of text: offsets of delimiters, line ends and quotes, behind one that stands
/// before its first byte.
struct Edges {
    alignas(64) std::array<std::int32_t, stretch_bytes + 64> place;
    std::size_t count = 0;  ///< without the first
    std::size_t line_ends = 0;
    /// There are some: quotes, carriage returns that end no line, control characters beside these (or a form
    /// feed, or a tab).
    bool quotes = false, returns = false, controls = false;
};

/// Fills `found` from the first `size` (at most stretch_bytes) bytes of `text`.
void find_edges(const char* text, std::size_t size, Separators separators, Edges& found);

/// Adds the bytes from `at` on, one by one, behind those that the vectors have looked at.
void find_last_edges(const char* text, std::size_t at, std::size_t size, Separators separators, Edges& found);

/// Of the cells between `count` + 1 places, in bytes.
[[nodiscard]] std::int32_t longest_cell(const std::int32_t* place, std::size_t count);

/// How many rows from the first on have each separator where it belongs.
[[nodiscard]] std::size_t regular_rows(const char* text, const Edges& edges, Separators separators,
                                       std::size_t columns);

}  // namespace ripplenotch
