// SPDX-License-Identifier: MIT
#pragma once
// Internal to the log room: where the cells of a stretch of text begin and end.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace ripplenotch {

inline constexpr std::size_t stretch_bytes = 8192;

/// What separates the cells of a stretch of text: offsets of delimiters, line ends and quotes, behind one
/// that stands before its first byte.
struct Edges {
    alignas(64) std::array<std::int32_t, stretch_bytes + 64> place;
    std::size_t count = 0;  ///< without the first
    std::size_t line_ends = 0;
    /// There are some: quotes, carriage returns that end no line, control characters beside these (or a form
    /// feed, or a tab).
    bool quotes = false, returns = false, controls = false;
};

/// Fills `found` from the first `size` (at most stretch_bytes) bytes of `text`.
void find_edges(const char* text, std::size_t size, char delimiter, Edges& found);

/// The length in bytes of the longest cell between `count` + 1 places.
[[nodiscard]] std::int32_t longest_cell(const std::int32_t* place, std::size_t count);

/// How many rows from the first on have each separator where it belongs.
[[nodiscard]] std::size_t regular_rows(const char* text, const Edges& edges, char delimiter,
                                       std::size_t columns);

// Internal to the log room: what the vectors that read numbers need to know of each length and each place of
// a decimal mark, made when this is compiled.

inline constexpr std::size_t lane_bytes = 16;

/// Masks of a lane's bytes, in which a number is at the end. `keep` goes by the length of the number; the
/// others by the place of its mark, which is 16 where it has none.
struct CellMasks {
    using Lane = std::array<std::uint8_t, lane_bytes>;
    alignas(64) std::array<Lane, 17> keep{};   ///< the number
    alignas(16) std::array<Lane, 17> most{};   ///< the greatest value of a byte
    alignas(16) std::array<Lane, 17> apart{};  ///< all but the mark
    alignas(16) std::array<Lane, 17> spare{};  ///< bytes that may be missing: all but the mark and last digit
    alignas(16) std::array<Lane, 17> close{};  ///< a shuffle that closes the gap which the mark leaves
    alignas(32) std::array<std::array<std::uint8_t, 32>, 33> keep_long{};  ///< a number in 32 bytes
    alignas(16) std::array<std::array<double, 2>, 4> signs{
        {{0.0, 0.0}, {-0.0, 0.0}, {0.0, -0.0}, {-0.0, -0.0}}};
    std::array<double, 17> power{};  ///< of ten, for the digits behind the mark

    constexpr CellMasks() {
        for (std::size_t length = 0; length <= 32; ++length) {
            for (std::size_t i = 0; i < 32; ++i) keep_long[length][i] = i >= 32 - length ? 0xFF : 0;
        }
        double ten_to = 1.0;
        for (std::size_t at = lane_bytes; at-- > 0; ten_to *= 10.0) power[at] = ten_to;
        power[lane_bytes] = 1.0;
        for (std::size_t at = 0; at <= lane_bytes; ++at) {
            for (std::size_t i = 0; i < lane_bytes; ++i) {
                const auto from = static_cast<std::uint8_t>(i == 0 ? 0x80 : i - 1);  // 0x80 gives a zero
                keep[at][i] = i >= lane_bytes - at ? 0xFF : 0;
                most[at][i] = i == at ? 0 : 9;
                apart[at][i] = i == at ? 0 : 0xFF;
                spare[at][i] = i == std::min(at, lane_bytes - 1) ? 0 : 0xFF;
                close[at][i] = at < lane_bytes && i <= at ? from : static_cast<std::uint8_t>(i);
            }
        }
        most[lane_bytes][0] = 0;  // sixteen digits may not fit into a double
    }
};

inline constexpr CellMasks cell_masks;

// Internal to the log room: one column of cells into numbers, by vector instructions.

/// The cells of one column: cell r lies between before[r * before_stride] and end[r * end_stride] (offsets
/// into `text` of the character just before and of the one just after it). In a plain column these are
/// neighbours, end = before + 1 with one stride, and no cell is longer than a lane of the vectors.
struct CellColumn {
    const char* text = nullptr;
    const std::int32_t *before = nullptr, *end = nullptr;
    std::size_t before_stride = 1, end_stride = 1, rows = 0;
    char decimal_mark = '.';
    bool plain = false;
};

/// Writes the number of each cell of the form [-]digits[mark digits] into `numbers`, correctly rounded. Sets
/// odd[r] for the others and where it is not sure, and returns whether there was one. 33 bytes before the end
/// of each cell must be readable.
bool read_cells(const CellColumn& column, double* numbers, std::uint8_t* odd);

}  // namespace ripplenotch
