// SPDX-License-Identifier: MIT
#pragma once
// Rows by vector instructions, stretch by stretch: find the delimiters, 64 bytes at a time; see how many rows
// have them where they belong; read these rows column by column; let the parser of rows have the few that the
// vectors are not sure of.

#include <cstddef>

#include "log/text/quick_rows.hpp"

namespace ripplenotch {

/// As QuickRows::take, where there are wide vectors and for rows whose delimiter is one character. `parser`
/// reads rows with cells that the vectors cannot: longer than 32 characters, with an exponent, padded with
/// blanks.
std::size_t read_rows_by_vectors(RowBlock& block, std::size_t begin, double time_before, const RowPlan& plan,
                                 const RowParser& parser);

}  // namespace ripplenotch
