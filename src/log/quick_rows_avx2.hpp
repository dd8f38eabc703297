// SPDX-License-Identifier: MIT
#pragma once
// Internal to the log room: the vectorised way of QuickRows, for x86-64 processors with AVX2.

#include <cstddef>

#include "core/processor.hpp"
#include "log/quick_rows.hpp"

namespace ripplenotch {

/// As QuickRows::take, for rows whose delimiter is one character. `parser` reads rows with cells that the
/// vectors cannot: longer than 16 characters, with an exponent, padded with blanks.
std::size_t take_rows_avx2(RowBlock& block, std::size_t begin, double time_before, const RowPlan& plan,
                           const RowParser& parser);

}  // namespace ripplenotch
