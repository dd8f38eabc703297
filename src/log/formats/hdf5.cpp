// SPDX-License-Identifier: MIT
// HDF5 files, and MAT files of version 7.3, which are such.

#include <array>

#include "log/containers/hdf5.hpp"
#include "log/formats.hpp"

namespace ripplenotch {
namespace {

constexpr std::array<std::string_view, 2> extensions = {".h5", ".hdf5"};
constexpr std::string_view magic = "\x89HDF\r\n\x1a\n", matlab_head = "MATLAB 7.3";

// MATLAB puts a head of text in front.
bool sniff(std::string_view bytes) { return bytes.starts_with(magic) || bytes.starts_with(matlab_head); }

ColumnLog make_hdf5(std::unique_ptr<ByteSource> source, std::string first_bytes, const ReadOptions& options) {
    const bool matlab = first_bytes.starts_with(matlab_head);
    const auto file = store_bytes(std::move(source), std::move(first_bytes));
    const Hdf5Contents found = find_hdf5_arrays(file, matlab);
    return columns_of_arrays(file, "hdf5", matlab ? PathStyle::matlab : PathStyle::numpy, found.arrays,
                             found.others, options);
}

#if defined(RIPPLENOTCH_HAS_HDF5)
std::unique_ptr<LogWriter> convert(std::unique_ptr<ByteSink> sink, const LogReader& reader,
                                   const WriteOptions& options) {
    return convert_rows(std::move(sink), reader, options, make_hdf5_table);
}

void write_columns(ByteSink& sink, std::span<const NumberColumn> columns) {
    write_table(sink, columns, make_hdf5_table);
}
#endif

}  // namespace

const LogFormat formats::hdf5 {
    .name = "hdf5", .summary = "HDF5 files, and MATLAB's of version 7.3: datasets by path",
    .extensions = extensions, .binary = true,
    .lacks =
#if defined(RIPPLENOTCH_HAS_HDF5)
        {},
#else
        "libhdf5",
#endif
    .sniff = sniff, .open = open_as_columns<make_hdf5>,
#if defined(RIPPLENOTCH_HAS_HDF5)
    .convert = convert, .write_columns = write_columns,
#endif
};

}  // namespace ripplenotch
