// SPDX-License-Identifier: MIT
#pragma once
// The header of a NumPy array file: which bytes of a record are which column. Format: NumPy Enhancement
// Proposal 1, versions 1.0, 2.0 and 3.0.

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "log/npy/npy_field.hpp"

namespace ripplenotch {

struct NpyHeader {
    std::vector<NpyField> fields;
    bool structured = false;
    std::size_t rows = 0;
    std::size_t record_size = 0;  ///< bytes a row
    std::size_t data_offset = 0;  ///< bytes before the first record
    std::string descr;            ///< as written in the file, for headers with a column more
    int version = 1;
    bool by_columns = false;  ///< the bytes of a column stand together: Fortran order, or one row a signal
    bool transposed = false;  ///< the file has one row a signal
};

inline constexpr std::size_t largest_npy_header = std::size_t{1} << 20;
/// Of records, that are looked at before columns are chosen.
inline constexpr std::size_t npy_sample_bytes = std::size_t{1} << 16;
inline constexpr std::string_view npy_magic = "\x93NUMPY";

/// Bytes that the header occupies, from the first 12 bytes of a file; 0 when they are too few or no header.
[[nodiscard]] std::size_t npy_header_size(std::string_view first_bytes);

/// Throws DataError that begins with `source` on a damaged header and on arrays that are no log: objects,
/// more than two dimensions, columns stored one after the other (Fortran order), no numbers.
[[nodiscard]] NpyHeader parse_npy_header(std::string_view bytes, const std::string& source);

/// A whole header, padded to a multiple of 64 bytes as numpy.save does. `shape` is the text inside the
/// brackets. With `reserve_rows`, space for any number of rows is left, so that a later header of the same
/// fields has the same size.
[[nodiscard]] std::string make_npy_header(std::string_view descr, std::string_view shape, bool reserve_rows);

}  // namespace ripplenotch
