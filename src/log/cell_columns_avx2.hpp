// SPDX-License-Identifier: MIT
#pragma once
// Internal to the log room: one column of cells into numbers, by AVX2.

#include <cstddef>
#include <cstdint>

namespace ripplenotch {

/// The cells of one column: cell r lies between the separators edges[r * stride] and edges[r * stride + 1]
/// (offsets into `text` of the characters just before and just after it).
struct CellColumn {
    const char* text = nullptr;
    const std::int32_t* edges = nullptr;
    std::size_t stride = 1, rows = 0;
    bool last = false;  ///< of its line: a carriage return at its end is not part of it
    char decimal_mark = '.';
};

/// Writes the number of each cell of the form [-]digits[mark digits] into `numbers`, correctly rounded. Sets
/// odd[r] for the others and where it is not sure, and returns whether there was one. 33 bytes before the end
/// of each cell must be readable.
bool read_cells_avx2(const CellColumn& column, double* numbers, std::uint8_t* odd);

}  // namespace ripplenotch
