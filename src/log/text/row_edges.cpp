// SPDX-License-Identifier: MIT
#include "log/text/row_edges.hpp"

#include <algorithm>

#include "log/text/text_cells.hpp"

namespace ripplenotch {
namespace {

/// How many rows from the first on end where they should.
std::size_t ended_rows(const char* text, const Edges& edges, char line_end, std::size_t columns) {
    const std::size_t most = edges.count / columns;
    const std::int32_t* edge = edges.place.data() + columns;
    for (std::size_t row = 0; row < most; ++row, edge += columns) {
        if (text[*edge] != line_end) return row;
    }
    return most;
}

}  // namespace

void find_last_edges(const char* text, std::size_t at, std::size_t size, Separators separators,
                     Edges& found) {
    for (; at < size; ++at) {
        const bool quote = text[at] == '"', line_end = text[at] == separators.line_end;
        if (quote || line_end || text[at] == separators.delimiter)
            found.place[++found.count] = static_cast<std::int32_t>(at);
        found.quotes |= quote;
        found.returns |= text[at] == '\r';
        found.controls |= is_control(text[at]);
        found.line_ends += line_end ? 1 : 0;
    }
    found.returns &= separators.line_end != '\r';
}

std::int32_t longest_cell(const std::int32_t* place, std::size_t count) {
    std::int32_t longest = 0;
    for (std::size_t i = 0; i < count; ++i) longest = std::max(longest, place[i + 1] - place[i] - 1);
    return longest;
}

std::size_t regular_rows(const char* text, const Edges& edges, Separators separators, std::size_t columns) {
    const std::size_t ended = ended_rows(text, edges, separators.line_end, columns);
    // Then there is no line end but the last of each row.
    if (!edges.quotes && !edges.controls && ended == edges.line_ends) return ended;
    const std::int32_t* edge = edges.place.data() + 1;
    for (std::size_t row = 0; row < ended; ++row, edge += columns) {
        for (std::size_t c = 0; c + 1 < columns; ++c) {
            if (text[edge[c]] != separators.delimiter) return row;
        }
        if (edges.controls && std::any_of(text + edge[-1] + 1, text + edge[columns - 1], is_control))
            return row;
    }
    return ended;
}

}  // namespace ripplenotch
