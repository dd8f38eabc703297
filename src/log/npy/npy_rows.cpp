// SPDX-License-Identifier: MIT
#include "log/npy/npy_rows.hpp"

#include <fmt/format.h>

#include "log/records/strided_copy.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

std::string npy_by_rows(std::string_view file, const NpyHeader& header, const std::string& source) {
    const std::size_t columns = header.fields.size(), size = header.fields.front().size;
    const std::string_view data = file.substr(header.data_offset);
    if (data.size() != header.rows * header.record_size) {
        raise<DataError>(
            "{}: read {} bytes of numbers, expected {}; the file is cut off, save the array again", source,
            data.size(), header.rows * header.record_size);
    }
    std::string rows = make_npy_header(header.descr, fmt::format("{}, {}", header.rows, columns), false);
    const std::size_t start = rows.size();
    rows += data;
    if (!header.by_columns) return rows;
    for (std::size_t c = 0; c < columns; ++c) {
        copy_numbers({data.data() + c * header.rows * size, size},
                     {rows.data() + start + c * size, columns * size}, size, header.rows);
    }
    return rows;
}

}  // namespace ripplenotch
