// SPDX-License-Identifier: MIT
#pragma once
// Arrays that are not stored row by row, turned into such.

#include <string>
#include <string_view>

#include "log/npy/npy_header.hpp"

namespace ripplenotch {

/// The same array as a file stored row by row, one row a time: from all the bytes of a file whose `header`
/// is by_columns or transposed. Throws DataError, beginning with `source`, when bytes are missing.
[[nodiscard]] std::string npy_by_rows(std::string_view file, const NpyHeader& header,
                                      const std::string& source);

}  // namespace ripplenotch
