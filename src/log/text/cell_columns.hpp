// SPDX-License-Identifier: MIT
#pragma once
// Internal to the log room: one column of cells into numbers, by vector instructions.

#include <cstddef>
#include <cstdint>

namespace ripplenotch {

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

/// On its way down a column.
struct CellCursor {
    CellCursor(const CellColumn& column, std::size_t row)
        : text(column.text),
          before(column.before + row * column.before_stride),
          end(column.end + row * column.end_stride),
          before_stride(column.before_stride),
          end_stride(column.end_stride) {}

    void advance(std::size_t rows) {
        before += rows * before_stride;
        end += rows * end_stride;
    }
    /// Of the cell, with its sign.
    [[nodiscard]] std::size_t length() const { return static_cast<std::size_t>(*end - *before - 1); }

    const char* text;
    const std::int32_t *before, *end;
    std::size_t before_stride, end_stride;
};

/// Writes the number of each cell of the form [-]digits[mark digits] into `numbers`, correctly rounded. Sets
/// odd[r] for the others and where it is not sure, and returns whether there was one. 33 bytes before the end
/// of each cell must be readable.
bool read_cells(const CellColumn& column, double* numbers, std::uint8_t* odd);

}  // namespace ripplenotch
