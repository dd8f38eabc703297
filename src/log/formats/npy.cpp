// SPDX-License-Identifier: MIT
// NumPy array files: structured arrays, whose field names are column names, and plain two-dimensional ones.

#include <array>

#include "log/formats.hpp"
#include "log/npy/npy_writer.hpp"

namespace ripplenotch {
namespace {

constexpr std::array<std::string_view, 1> extensions = {".npy"};

bool sniff(std::string_view first_bytes) { return first_bytes.substr(0, npy_magic.size()) == npy_magic; }

}  // namespace

const LogFormat formats::npy{
    .name = "npy",
    .summary = "NumPy array files, structured or plain",
    .extensions = extensions,
    .binary = true,
    .sniff = sniff,
    .open = open_as_columns<make_npy>,
    .rewrite = rewrite_with<NpyWriter, ColumnReader>,
    .convert = convert_with<NpyTableWriter>,
    .write_columns = write_columns_with<NpyTableWriter>,
};

}  // namespace ripplenotch
