// SPDX-License-Identifier: MIT
#pragma once
// What columns of samples explain of another one: bases at right angles, and the square of a projection.

#include <span>
#include <vector>

namespace ripplenotch {

/// One number a sample.
using Column = std::vector<double>;

/// Sum of products of two columns of the same length.
[[nodiscard]] double product(const Column& a, const Column& b);

/// Columns of length 1 at right angles that span what `columns` span, the first column first; what is a
/// combination of the columns before it, to a part in ten million, is left out.
[[nodiscard]] std::vector<Column> orthonormal(std::span<const Column> columns);

/// Of a column, what lies outside the basis, whose columns are orthonormal().
[[nodiscard]] Column outside_of(std::span<const Column> basis, Column column);

/// Square of what the basis and the columns together explain of `left`, in its unit squared: as by
/// orthonormal() of all of them, but from their products alone, which takes a third of the time. A column is
/// left out where it is a combination of the others to a part in a hundred thousand: products know no better.
[[nodiscard]] double explained(std::span<const Column> basis, std::span<const Column> columns,
                               const Column& left);

}  // namespace ripplenotch
