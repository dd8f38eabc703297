// SPDX-License-Identifier: MIT
// MAT files of versions 5, 6 and 7. Those of version 7.3 are HDF5.

#include <array>

#include "log/containers/mat.hpp"
#include "log/formats.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

constexpr std::array<std::string_view, 1> extensions = {".mat"};

// Text of 116 bytes, then version and byte order; that of version 7.3 is 2.
bool sniff(std::string_view bytes) {
    if (bytes.size() < 128) return false;
    const std::string_view order = bytes.substr(126, 2);
    const bool little = order == "IM", big = order == "MI";
    const char version = little ? bytes[125] : bytes[124];
    return (little || big) && version == 1;
}

ColumnLog make_mat(std::unique_ptr<ByteSource> source, std::string first_bytes, const ReadOptions& options) {
    if (!sniff(first_bytes))
        raise<DataError>("{}: read no head of a MAT file, expected one; leave out --format", source->name());
    const auto file = store_bytes(std::move(source), std::move(first_bytes));
    const MatContents found = find_mat_arrays(file);
    return columns_of_arrays(file, "mat", PathStyle::matlab, found.arrays, found.others, options);
}

}  // namespace

const LogFormat formats::mat{
    .name = "mat",
    .summary = "MATLAB files (versions 5 to 7; 7.3 is HDF5): vectors and matrices by name, fields of structs",
    .extensions = extensions,
    .binary = true,
    .sniff = sniff,
    .open = open_as_columns<make_mat>,
    .convert = convert_with<MatTableWriter>,
    .write_columns = write_columns_with<MatTableWriter>,
};

}  // namespace ripplenotch
