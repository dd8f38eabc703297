// SPDX-License-Identifier: MIT
#pragma once
// Rows by vector instructions, stretch by stretch: find the delimiters, 64 bytes at a time; see how many rows
// have them where they belong; read these rows column by column; let the parser of rows have the few that the
// vectors are not sure of.

#include <cstddef>

#include "log/cell_columns.hpp"
#include "log/quick_rows.hpp"
#include "log/row_edges.hpp"

namespace ripplenotch {

/// What depends on the instruction set.
struct VectorKernels {
    void (*find_edges)(const char* text, std::size_t size, Separators separators, Edges& found);
    bool (*read_cells)(const CellColumn& column, double* numbers, std::uint8_t* odd);
};

/// Null on processors that cannot run them.
[[nodiscard]] const VectorKernels* avx2_kernels();
[[nodiscard]] const VectorKernels* avx512_kernels();

/// As QuickRows::take, for rows whose delimiter is one character. `parser` reads rows with cells that the
/// vectors cannot: longer than 32 characters, with an exponent, padded with blanks.
std::size_t take_rows_by_vectors(RowBlock& block, std::size_t begin, double time_before, const RowPlan& plan,
                                 const RowParser& parser, const VectorKernels& kernels);

}  // namespace ripplenotch
